// The identity of the C library's mathematical functions.
#include "engine/core/math_library.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>

namespace ed3r {
namespace {

// What this test prints when it runs again with the CPU's fused multiply-add hidden from the C library.
std::string IdentityWith(const std::string& tunables) {
  const std::string command = "GLIBC_TUNABLES=" + tunables + " " + ED3R_TEST_CORE +
                              " --gtest_also_run_disabled_tests --gtest_filter='*PrintsIt'";
  const std::unique_ptr<FILE, int (*)(FILE*)> out(popen(command.c_str(), "r"), pclose);
  std::string text;
  for (char line[256]; std::fgets(line, sizeof(line), out.get()) != nullptr;) text += line;
  const std::size_t at = text.find("identity ");
  return at == std::string::npos ? text : text.substr(at + 9, 16);
}

TEST(MathLibraryTest, DISABLED_PrintsIt) { std::printf("identity %s\n", MathLibraryIdentity().c_str()); }

TEST(MathLibraryTest, IsTheSameEveryTime) {
  EXPECT_EQ(MathLibraryIdentity().size(), 16u);
  EXPECT_EQ(MathLibraryIdentity(), MathLibraryIdentity());
  EXPECT_EQ(IdentityWith("glibc.malloc.check=0"), MathLibraryIdentity());
}

TEST(MathLibraryTest, TellsTheVariantsOfTheCLibraryApart) {
  if (!__builtin_cpu_supports("fma"))
    GTEST_SKIP() << "this CPU has no fused multiply-add: there is one variant";
  EXPECT_NE(IdentityWith("glibc.cpu.hwcaps=-AVX2,-FMA"), MathLibraryIdentity());
}

}  // namespace
}  // namespace ed3r
