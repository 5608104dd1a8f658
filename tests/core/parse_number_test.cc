#include "engine/core/parse_number.h"

#include <gtest/gtest.h>

#include <cstdint>

namespace ed3r {
namespace {

TEST(ParseNumberTest, WhatIsWrittenInOneWayIsRead) {
  EXPECT_EQ(ParseNumber<int>("0"), 0);
  EXPECT_EQ(ParseNumber<int>("-10"), -10);
  EXPECT_EQ(ParseNumber<std::uint64_t>("18446744073709551615"), UINT64_MAX);
  EXPECT_EQ(ParseNumber<double>("0.5"), 0.5);
  EXPECT_EQ(ParseNumber<double>("-0.5e-3"), -0.5e-3);
  EXPECT_EQ(ParseNumber<double>("100"), 100.0);
}

TEST(ParseNumberTest, WhatReadersReadInTwoWaysIsNone) {
  for (const char* text : {"010", "-010", "00", "01.5", "+1", "+-1", " 1", "1 ", "1,5", "0x10", "1_000", "",
                           "-", "1e", "1e999"}) {
    EXPECT_FALSE(ParseNumber<int>(text)) << text;
    EXPECT_FALSE(ParseNumber<double>(text)) << text;
  }
  EXPECT_FALSE(ParseNumber<std::uint64_t>("-1"));
  EXPECT_FALSE(ParseNumber<std::uint64_t>("18446744073709551616"));
}

TEST(ParseNumberTest, APlusIsNoPartOfANumberUnlessOneFollows) {
  EXPECT_EQ(WithoutPlus("+1"), "1");
  EXPECT_EQ(WithoutPlus("+.5"), ".5");
  for (const char* text : {"+-1", "++1", "+", "", "1", "-1"}) EXPECT_EQ(WithoutPlus(text), text);
}

}  // namespace
}  // namespace ed3r
