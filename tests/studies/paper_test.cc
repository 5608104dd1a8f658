#include <gtest/gtest.h>

#include <set>

#include "engine/core/check.h"
#include "studies/metrics/definitions.h"
#include "studies/paper/claims.h"

namespace ed3r {
namespace {

TEST(ClaimsTest, AreAllThere) {
  const std::vector<paper::Claim>& claims = paper::PaperClaims();
  EXPECT_EQ(claims.size(), 177u);
  std::set<std::string> ids, kinds;
  for (const paper::Claim& claim : claims) ids.insert(claim.id), kinds.insert(claim.kind);
  EXPECT_EQ(ids.size(), claims.size());
  EXPECT_EQ(kinds, (std::set<std::string>{"order", "ratio", "setup", "share", "value"}));
}

TEST(ClaimsTest, OtherColumnsAreRefused) {
  EXPECT_THROW(paper::ParseClaims("id,where\nC1,here\n", "b.csv"), UserError);
  EXPECT_THROW(paper::ParseClaims("", "b.csv"), UserError);
}

TEST(PaperValueTest, TableGoesBeforeText) {
  const auto value = paper::FindPaperValue(paper::PaperClaims(), "ed3r-75", "total_energy_kj");
  ASSERT_TRUE(value);
  EXPECT_EQ(value->value, 21.44);
  EXPECT_EQ(value->printed, "21.44");
  EXPECT_EQ(value->claim, "C104");
  EXPECT_DOUBLE_EQ(value->half_unit, 0.005);
  EXPECT_EQ(value->elsewhere, std::vector<std::string>{"21.33 (C012)"});
}

TEST(PaperValueTest, AgreeingRepetitionsAreNoContradiction) {
  const auto value = paper::FindPaperValue(paper::PaperClaims(), "ed3r-75", "msr_pct");
  ASSERT_TRUE(value);
  EXPECT_EQ(value->value, 97.18);
  EXPECT_TRUE(value->elsewhere.empty());
}

TEST(PaperValueTest, ApproximateDerivedAndConstructed) {
  const auto longest = paper::FindPaperValue(paper::PaperClaims(), "ed3r-85", "duration_max_min");
  ASSERT_TRUE(longest);
  EXPECT_TRUE(longest->approximate);
  EXPECT_FALSE(longest->derived);
  EXPECT_DOUBLE_EQ(longest->half_unit, 0.5);
  EXPECT_TRUE(paper::FindPaperValue(paper::PaperClaims(), "ed3r-85", "msr_pct")->derived);
  EXPECT_TRUE(paper::FindPaperValue(paper::PaperClaims(), "ablation-4", "or_pct")->derived);
}

TEST(PaperValueTest, SharesOfMissionsAreValues) {
  const auto within = paper::FindPaperValue(paper::PaperClaims(), "ed3r-65", "within_10min_pct");
  ASSERT_TRUE(within);
  EXPECT_EQ(within->value, 97);
}

TEST(PaperValueTest, NothingIsNothing) {
  EXPECT_FALSE(paper::FindPaperValue(paper::PaperClaims(), "rbs", "lf_accuracy_pct"));  // "n/a"
  EXPECT_FALSE(paper::FindPaperValue(paper::PaperClaims(), "ed3r-75", "mean_power_w"));
  EXPECT_FALSE(paper::FindPaperValue(paper::PaperClaims(), "somebody", "msr_pct"));
  EXPECT_FALSE(
      paper::FindPaperValue(paper::PaperClaims(), "ablation-3", "total_energy_kj"));  // only an order
}

// A metric renamed on one side only would silently lose its paper values.
TEST(PaperValueTest, CoversTheTableOfBaselines) {
  for (const char* arm : {"ed3r-75", "ecd2r", "rbs", "ed3r-p85", "ecd2r-p85", "rbs-p85"})
    for (const char* metric : {"total_energy_kj", "mscs_pct", "msr_pct", "wer_pct", "duration_mean_min"}) {
      const auto value = paper::FindPaperValue(
          paper::PaperClaims(), arm, metrics::MetricDefinitions()[metrics::MetricIndex(metric)].name);
      ASSERT_TRUE(value) << arm << ' ' << metric;
      EXPECT_GE(value->claim, "C104");
      EXPECT_LE(value->claim, "C139");
    }
}

}  // namespace
}  // namespace ed3r
