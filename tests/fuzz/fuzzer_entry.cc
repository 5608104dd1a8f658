// libFuzzer's way in; ED3R_FUZZ_TARGET is a function of targets.h.
#include "tests/fuzz/targets.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  ed3r::ED3R_FUZZ_TARGET({reinterpret_cast<const char*>(data), size});
  return 0;
}
