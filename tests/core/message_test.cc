#include "engine/core/message.h"

#include <gtest/gtest.h>

namespace ed3r {
namespace {

TEST(MessageTest, AMessageIsOneLineOfBoundedLength) {
  EXPECT_EQ(OneLine("a\nb\tc"), "a\\x0ab\\x09c");
  EXPECT_EQ(OneLine(std::string(500, 'x')), std::string(500, 'x'));
  const std::string line = OneLine("begin" + std::string(1'000'000, 'x') + "end");
  EXPECT_EQ(line.size(), 500u);
  EXPECT_TRUE(line.starts_with("begin"));
  EXPECT_TRUE(line.ends_with("end"));
  std::string euros;
  for (int i = 0; i < 1000; ++i) euros += "\xe2\x82\xac";
  for (const char* start : {"", "a", "ab"}) {
    const std::string cut = OneLine(start + euros);
    EXPECT_LE(cut.size(), 500u);
    EXPECT_NE(cut.find("\xe2\x82\xac ... \xe2\x82\xac"), std::string::npos) << start;
  }
}

}  // namespace
}  // namespace ed3r
