# Run at every build: writes OUTPUT only when something changed. A result is a function of (sweep, seed, code), so the
# code's identity is a hash of the sources that results depend on; the commit is told beside it.
file(GLOB_RECURSE sources RELATIVE "${SOURCE_DIR}"
  "${SOURCE_DIR}/kernels/*.cc" "${SOURCE_DIR}/kernels/*.h" "${SOURCE_DIR}/engine/*.cc" "${SOURCE_DIR}/engine/*.h"
  "${SOURCE_DIR}/engine/*.ed3rnet")
list(FILTER sources EXCLUDE REGEX "^(engine/app|kernels/bench|engine/store|engine/schedule)/")
list(SORT sources)
set(all "")
foreach(source ${sources})
  file(SHA256 "${SOURCE_DIR}/${source}" hash)
  string(APPEND all "${source} ${hash}\n")
endforeach()
string(SHA256 source_hash "${all}")
string(SUBSTRING "${source_hash}" 0 16 source_hash)

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

CodeVersion ThisCode() { return {"@source_hash@", "@commit@", @dirty@, "@COMPILER@", "@FLAGS@"}; }

}  // namespace ed3r
]] @ONLY)
