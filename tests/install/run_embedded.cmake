# Configures a project that has mallow as a folder; compiling it is what the other cases do.
file(REMOVE_RECURSE ${WORK_DIR})
file(COPY ${SOURCE_DIR}/tests/install/embedded/ DESTINATION ${WORK_DIR})
file(COPY ${SOURCE_DIR}/tools/examples/hello.cpp DESTINATION ${WORK_DIR})
file(CREATE_LINK ${SOURCE_DIR} ${WORK_DIR}/mallow SYMBOLIC)
execute_process(COMMAND ${CMAKE_COMMAND} -S ${WORK_DIR} -B ${WORK_DIR}/build -G ${GENERATOR} -DCMAKE_CXX_COMPILER=${COMPILER}
  COMMAND_ERROR_IS_FATAL ANY)
