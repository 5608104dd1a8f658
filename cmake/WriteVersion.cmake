# Run at every build: writes OUTPUT only when something changed. A result is a function of (sweep, seed, code), so the
# code's identity is a hash of the sources that results depend on (code_identity.py); the commit is told beside it.
find_program(PYTHON NAMES python3 REQUIRED)
execute_process(COMMAND "${PYTHON}" "${CMAKE_CURRENT_LIST_DIR}/code_identity.py" "${SOURCE_DIR}"
  OUTPUT_VARIABLE identities OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
string(SHA256 source_hash "${identities}")
string(SUBSTRING "${source_hash}" 0 16 source_hash)
foreach(subsystem flight pixels training precision)
  if(NOT identities MATCHES "(^|\n)${subsystem} ([0-9a-f]+)")
    message(FATAL_ERROR "code_identity.py says nothing about ${subsystem}")
  endif()
  set(${subsystem} "${CMAKE_MATCH_2}")
endforeach()

set(commit "unknown")
set(dirty false)
find_package(Git QUIET)
if(GIT_FOUND)
  execute_process(COMMAND "${GIT_EXECUTABLE}" -C "${SOURCE_DIR}" rev-parse --short=12 HEAD
    OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE status)
  if(NOT status EQUAL 0)
    set(commit "unknown")
  endif()
  execute_process(COMMAND "${GIT_EXECUTABLE}" -C "${SOURCE_DIR}" status --porcelain
    OUTPUT_VARIABLE changes ERROR_QUIET)
  if(changes)
    set(dirty true)
  endif()
endif()

file(CONFIGURE OUTPUT "${OUTPUT}" CONTENT [[#include "engine/core/version.h"

namespace ed3r {

CodeVersion ThisCode() {
  return {"@RELEASE@", "@source_hash@", "@flight@", "@pixels@", "@training@", "@precision@", "@commit@", @dirty@, "@COMPILER@", "@FLAGS@"};
}

}  // namespace ed3r
]] @ONLY)
