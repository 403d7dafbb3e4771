# Runs Doxygen and fails where it warns. A field whose name says all needs no comment, so that Doxygen's word on those is
# passed over; types, functions and constants need one each.
execute_process(COMMAND ${DOXYGEN} ${FOLDER}/Doxyfile RESULT_VARIABLE result)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "doxygen ended with ${result}")
endif()
file(STRINGS ${FOLDER}/warnings.txt warnings)
list(FILTER warnings EXCLUDE REGEX "Member .* \\(variable\\) of (struct|class) .* is not documented")
if(warnings)
  list(JOIN warnings "\n" text)
  message(FATAL_ERROR "the documentation is not right:\n${text}")
endif()
message(STATUS "documentation: ${FOLDER}/html/index.html")
