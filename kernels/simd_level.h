// Which instruction set the hand-written kernels use: chosen once at run time, forced by the environment
// variable ED3R_SIMD=scalar|avx2|avx512.
//
// All levels give the same bits (every sum has one order and is fused), so the level changes the speed of a
// result, never the result. It is stored with each result all the same, so that the claim can be checked.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace ed3r::kernels {

enum class SimdLevel { kScalar = 0, kAvx2 = 1, kAvx512 = 2 };

// ED3R_SIMD names a level that does not exist or that this CPU lacks. what() is one line that names the value
// and the levels of this CPU. This folder knows nothing of the engine; the program reports it as bad input.
class SimdLevelError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

const char* SimdLevelName(SimdLevel level);  // "scalar", "avx2", "avx512"
bool SimdLevelSupported(SimdLevel level);    // by this CPU, its operating system and this build
SimdLevel BestSimdLevel();                   // the widest supported one
std::string SupportedSimdLevels();           // "scalar avx2 avx512"

// The level that `text` names; empty text means BestSimdLevel(). Throws SimdLevelError.
SimdLevel ParseSimdLevel(std::string_view text);

// The level of this process: ED3R_SIMD as it was at the first call. Throws SimdLevelError at each call while
// the variable is wrong, so that a program should call it once before it starts work. Thread-safe.
SimdLevel ActiveSimdLevel();

}  // namespace ed3r::kernels
