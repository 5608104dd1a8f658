#include "engine/sweep/axis.h"

#include <gtest/gtest.h>

#include "engine/core/check.h"

namespace ed3r::sweep {
namespace {

using Values = std::vector<std::string>;

Values Range(const Values& numbers) {
  YamlNode range;
  range.kind = YamlNode::Kind::kList;
  range.at = "f:1:1";
  for (const std::string& number : numbers) {
    YamlNode node;
    node.kind = YamlNode::Kind::kScalar;
    node.at = "f:1:2";
    node.text = number;
    range.items.push_back(node);
  }
  return RangeValues(range, "k");
}

TEST(RangeTest, LastIsIncludedWithinRounding) {
  EXPECT_EQ(Range({"3.0", "4.0", "0.2"}), (Values{"3.0", "3.2", "3.4", "3.6", "3.8", "4.0"}));
  EXPECT_EQ(Range({"0.1", "0.3", "0.1"}), (Values{"0.1", "0.2", "0.3"}));
  EXPECT_EQ(Range({"0", "0.7", "0.1"}).size(), 8u);
  EXPECT_EQ(Range({"1", "2", "0.3"}), (Values{"1.0", "1.3", "1.6", "1.9"}));
  EXPECT_EQ(Range({"5", "5", "1"}), (Values{"5"}));
  for (int n = 1; n <= 2000; ++n)  // last = n x 0.001 as written
    ASSERT_EQ(Range({"0", std::to_string(n / 1000.0), "0.001"}).size(), static_cast<std::size_t>(n) + 1) << n;
}

TEST(RangeTest, ValuesHaveTheWrittenDecimals) {
  EXPECT_EQ(Range({"1e-3", "3e-3", "1e-3"}), (Values{"0.001", "0.002", "0.003"}));
  EXPECT_EQ(Range({"15e6", "30e6", "7.5e6"}), (Values{"15000000", "22500000", "30000000"}));
  EXPECT_EQ(Range({"0.125", "0.625", "0.25"}), (Values{"0.125", "0.375", "0.625"}));
  EXPECT_EQ(Range({"1e-25", "2e-25", "1e-25"}), (Values{"1e-25", "2e-25"}));
  EXPECT_EQ(Range({"0e-2147483648", "1", "1"}), (Values{"0", "1"}));
}

TEST(RangeTest, MayDescendAndPassZero) {
  EXPECT_EQ(Range({"0.3", "-0.3", "-0.1"}), (Values{"0.3", "0.2", "0.1", "0", "-0.1", "-0.2", "-0.3"}));
}

TEST(RangeTest, RefusesWhatLeadsNowhere) {
  for (const Values& numbers :
       {Values{"1", "2", "0"}, Values{"1", "1", "0"}, Values{"2", "1", "0.5"}, Values{"1", "2", "-0.5"},
        Values{"1", "2", "nan"}, Values{"1", "inf", "1"}, Values{"-1e308", "1e308", "1"},
        Values{"1", "2", "1e-320"}, Values{"1", "2", "0.5x"}, Values{"1", "2"}, Values{}}) {
    EXPECT_THROW(Range(numbers), UserError);
  }
}

}  // namespace
}  // namespace ed3r::sweep
