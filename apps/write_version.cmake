# Writes version.cpp with the hash of the checkout that is being built; rewrites only on change.
execute_process(COMMAND git -C ${SOURCE_DIR} describe --always --dirty
                OUTPUT_VARIABLE NLOS_GIT_HASH OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
if(NOT NLOS_GIT_HASH)
  set(NLOS_GIT_HASH "no git")
endif()
configure_file(${SOURCE_DIR}/apps/version.cpp.in ${OUTPUT} @ONLY)
