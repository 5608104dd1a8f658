#include "kernels/simd_level.h"

#include <cstdlib>

namespace ed3r::kernels {
namespace {

constexpr SimdLevel kLevels[] = {SimdLevel::kScalar, SimdLevel::kAvx2, SimdLevel::kAvx512};

}  // namespace

const char* SimdLevelName(SimdLevel level) {
  switch (level) {
    case SimdLevel::kScalar:
      return "scalar";
    case SimdLevel::kAvx2:
      return "avx2";
    case SimdLevel::kAvx512:
      return "avx512";
  }
  return "unknown";
}

bool SimdLevelSupported(SimdLevel level) {
#ifdef ED3R_KERNELS_X86
  switch (level) {
    case SimdLevel::kScalar:
      return true;
    case SimdLevel::kAvx2:
      return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
    case SimdLevel::kAvx512:
      return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx2") &&
             __builtin_cpu_supports("fma");
  }
  return false;
#else
  return level == SimdLevel::kScalar;
#endif
}

SimdLevel BestSimdLevel() {
  SimdLevel best = SimdLevel::kScalar;
  for (SimdLevel level : kLevels)
    if (SimdLevelSupported(level)) best = level;
  return best;
}

std::string SupportedSimdLevels() {
  std::string names;
  for (SimdLevel level : kLevels) {
    if (!SimdLevelSupported(level)) continue;
    if (!names.empty()) names += ' ';
    names += SimdLevelName(level);
  }
  return names;
}

SimdLevel ParseSimdLevel(std::string_view text) {
  if (text.empty()) return BestSimdLevel();
  for (SimdLevel level : kLevels) {
    if (text != SimdLevelName(level)) continue;
    if (SimdLevelSupported(level)) return level;
    throw SimdLevelError("ED3R_SIMD=" + std::string(text) +
                         ": this CPU does not have it; it has: " + SupportedSimdLevels());
  }
  throw SimdLevelError("ED3R_SIMD=" + std::string(text) +
                       ": unknown SIMD level; this CPU has: " + SupportedSimdLevels());
}

SimdLevel ActiveSimdLevel() {
  static const SimdLevel level = [] {
    const char* text = std::getenv("ED3R_SIMD");
    return ParseSimdLevel(text ? text : "");
  }();
  return level;
}

}  // namespace ed3r::kernels
