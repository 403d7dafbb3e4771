# Writes the page of every key that a scene file may hold, as `mallow keys` prints them.
execute_process(COMMAND ${PROGRAM} keys OUTPUT_VARIABLE keys COMMAND_ERROR_IS_FATAL ANY)
file(WRITE ${PAGE} "# Every key of a scene file\n```\n${keys}```\n")
