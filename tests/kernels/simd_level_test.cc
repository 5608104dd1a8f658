#include "kernels/simd_level.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>

#include "kernels/rfnn.h"
#include "tests/kernels/reference.h"

namespace ed3r::kernels {
namespace {

std::string ErrorOf(const char* text) {
  try {
    ParseSimdLevel(text);
  } catch (const SimdLevelError& error) {
    return error.what();
  }
  return "";
}

TEST(SimdLevelTest, ScalarIsAlwaysThere) {
  EXPECT_TRUE(SimdLevelSupported(SimdLevel::kScalar));
  EXPECT_EQ(ParseSimdLevel("scalar"), SimdLevel::kScalar);
  EXPECT_EQ(SupportedSimdLevels().rfind("scalar", 0), 0u);
}

TEST(SimdLevelTest, NamesAreReadBack) {
  for (SimdLevel level : LevelsHere()) EXPECT_EQ(ParseSimdLevel(SimdLevelName(level)), level);
  EXPECT_EQ(ParseSimdLevel(""), BestSimdLevel());
  EXPECT_EQ(BestSimdLevel(), LevelsHere().back());
}

TEST(SimdLevelTest, UnknownLevelIsAnErrorThatNamesWhatThereIs) {
  for (const char* text : {"sse2", "AVX2", "avx2 ", "0"}) {
    EXPECT_NE(ErrorOf(text).find(std::string("ED3R_SIMD=") + text), std::string::npos) << text;
    EXPECT_NE(ErrorOf(text).find("this CPU has: " + SupportedSimdLevels()), std::string::npos) << text;
  }
}

TEST(SimdLevelTest, LevelThatThisCpuLacksIsAnError) {
  for (SimdLevel level : {SimdLevel::kAvx2, SimdLevel::kAvx512}) {
    if (SimdLevelSupported(level)) continue;
    EXPECT_NE(ErrorOf(SimdLevelName(level)).find("does not have it; it has: scalar"), std::string::npos);
    const TestNet net({1, 1}, {1.0f, 0.0f});
    EXPECT_THROW(RfnnArgmax(net.net(), {}, net.workspace.data(), level), SimdLevelError);
  }
}

// In a process of its own: the level is decided once.
void ExitWithLevelOf(const char* variable) {
  setenv("ED3R_SIMD", variable, 1);
  try {
    std::fputs(SimdLevelName(ActiveSimdLevel()), stderr);
    std::exit(0);
  } catch (const SimdLevelError& error) {
    std::fputs(error.what(), stderr);
    std::exit(2);
  }
}

TEST(SimdLevelDeathTest, EnvironmentVariableForcesTheLevel) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  for (SimdLevel level : LevelsHere())
    EXPECT_EXIT(ExitWithLevelOf(SimdLevelName(level)), testing::ExitedWithCode(0), SimdLevelName(level));
  EXPECT_EXIT(ExitWithLevelOf(""), testing::ExitedWithCode(0), SimdLevelName(BestSimdLevel()));
  EXPECT_EXIT(ExitWithLevelOf("neon"), testing::ExitedWithCode(2), "ED3R_SIMD=neon.*unknown.*scalar");
}

}  // namespace
}  // namespace ed3r::kernels
