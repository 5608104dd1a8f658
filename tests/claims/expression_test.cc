#include "studies/claims/expression.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "engine/core/check.h"
#include "studies/metrics/definitions.h"

namespace ed3r::claims {
namespace {

// ed3r-65 is 2, ed3r-75 is 3, ed3r-85 is 5, ablation-N is 10 N, rbs is 7, everything else NaN.
double Toy(const Cell& cell) {
  static const std::map<std::string, double> values = {
      {"ed3r-65", 2},     {"ed3r-75", 3},     {"ed3r-85", 5},     {"rbs", 7},
      {"ablation-1", 10}, {"ablation-2", 20}, {"ablation-3", 30}, {"ablation-4", 40}};
  const auto found = values.find(cell.arm);
  return found == values.end() ? std::nan("") : found->second;
}

double Number(std::string_view text) {
  const Expression expression = ParseExpression(text, "total_energy_kj");
  EXPECT_TRUE(expression.is_quantity) << text;
  return ValueOf(expression.quantity, Toy);
}

bool True(std::string_view text, double tolerance = 0) {
  const Expression expression = ParseExpression(text, "total_energy_kj");
  EXPECT_FALSE(expression.is_quantity) << text;
  return Holds(expression.formula, tolerance, Toy);
}

std::string ErrorOf(std::string_view text, std::string_view metric = "total_energy_kj") {
  try {
    ParseExpression(text, metric);
  } catch (const UserError& error) {
    return error.what();
  }
  return "";
}

TEST(ExpressionTest, Arithmetic) {
  EXPECT_DOUBLE_EQ(Number("100*(1 - ed3r-65 / ed3r-85)"), 60);
  EXPECT_DOUBLE_EQ(Number("1 + 2*3 - 8/4"), 5);
  EXPECT_DOUBLE_EQ(Number("10 - 4 - 3"), 3);  // from the left
  EXPECT_DOUBLE_EQ(Number("16 / 4 / 2"), 2);
  EXPECT_DOUBLE_EQ(Number("max(ed3r-65, ed3r-85, ed3r-75)"), 5);
  EXPECT_DOUBLE_EQ(Number("min(ablation-1..4)"), 10);
  EXPECT_DOUBLE_EQ(Number("mean(1 - ed3r-65 / ed3r-85, ed3r-75)"), 1.8);
  EXPECT_DOUBLE_EQ(Number("1-ed3r-65"), -1);  // a name never starts with a digit
  EXPECT_DOUBLE_EQ(Number("rbs - ed3r-75"), 4);
}

TEST(ExpressionTest, MissingCellsAreNotANumber) {
  EXPECT_TRUE(std::isnan(Number("1 - ed3r-75 / ecd2r")));
  EXPECT_TRUE(std::isnan(Number("max(ed3r-75, ecd2r)")));
  EXPECT_FALSE(True("ed3r-75 < ecd2r"));
  EXPECT_FALSE(True("ecd2r < ed3r-75"));
  EXPECT_FALSE(True("ed3r-75 ~ ecd2r", 100));
}

TEST(ExpressionTest, ChainsListsAndRanges) {
  EXPECT_TRUE(True("ed3r-65 < ed3r-75 < ed3r-85"));
  EXPECT_FALSE(True("ed3r-65 < ed3r-85 < ed3r-75"));
  EXPECT_TRUE(True("ed3r-85 > ed3r-75 > ed3r-65"));
  EXPECT_TRUE(True("ed3r-75 < ablation-1..4"));
  EXPECT_FALSE(True("ablation-2 < ablation-3..4, ablation-1"));
  EXPECT_TRUE(True("ed3r-65, ed3r-75 < 4 < ed3r-85, rbs"));
  EXPECT_FALSE(True("ed3r-65 < ed3r-65"));  // a tie is no order
  EXPECT_TRUE(True("ed3r-65 < ed3r-75; rbs > ed3r-85"));
  EXPECT_FALSE(True("ed3r-65 < ed3r-75; rbs < ed3r-85"));
}

TEST(ExpressionTest, SimilarMeansWithinTheTolerance) {
  EXPECT_TRUE(True("ed3r-65 ~ ed3r-75, ed3r-85", 3.5));
  EXPECT_FALSE(True("ed3r-65 ~ ed3r-75, ed3r-85", 3));
}

TEST(ExpressionTest, MetricsByName) {
  const Expression expression =
      ParseExpression("movement_energy_kj(rbs) > msr_pct(rbs) + wer_pct(ed3r-75)", "tradeoff");
  const std::vector<Cell> cells = CellsOf(expression);
  ASSERT_EQ(cells.size(), 3u);
  EXPECT_EQ(cells[0], (Cell{"ed3r-75", metrics::MetricIndex("wer_pct")}));
  EXPECT_EQ(cells[1], (Cell{"rbs", metrics::MetricIndex("movement_energy_kj")}));
  EXPECT_EQ(cells[2], (Cell{"rbs", metrics::MetricIndex("msr_pct")}));
  EXPECT_EQ(TextOf(expression.formula), "msr_pct(rbs) + wer_pct(ed3r-75) < movement_energy_kj(rbs)");
}

// Energy and success of three arms, the others spend more and fail more.
double Pareto(const Cell& cell) {
  static const std::map<std::string, std::pair<double, double>> points = {
      {"ed3r-65", {10, 90}}, {"ed3r-75", {12, 95}}, {"ed3r-85", {14, 93}}};
  const auto found = points.find(cell.arm);
  const auto [energy, success] = found == points.end() ? std::pair(50.0, 50.0) : found->second;
  return cell.metric == metrics::MetricIndex("total_energy_kj") ? energy : success;
}

TEST(ExpressionTest, ParetoFrontier) {
  const auto holds = [](std::string_view text) {
    return Holds(ParseExpression(text, "pareto").formula, 0, Pareto);
  };
  EXPECT_TRUE(holds("frontier(ed3r-65, ed3r-75)"));
  EXPECT_FALSE(holds("frontier(ed3r-85)"));
  EXPECT_TRUE(holds("dominated(ed3r-85) by ed3r-75"));
  EXPECT_FALSE(holds("dominated(ed3r-85) by ed3r-65"));  // cheaper, but fails more
  EXPECT_TRUE(holds("dominated(rbs, ablation-1..4) by ed3r-85, ed3r-65"));
  EXPECT_FALSE(holds("dominated(ed3r-65, rbs) by ed3r-75"));
}

TEST(ExpressionTest, WhatDoesNotParseSaysWhere) {
  EXPECT_EQ(ErrorOf("ed3r-75 < ablaton-1"),
            "ed3r-75 < ablaton-1:11: 'ablaton-1' is no arm (nearest: ablation-1)");
  EXPECT_EQ(ErrorOf("msr_pc(rbs)"), "msr_pc(rbs):1: 'msr_pc' is no metric (nearest: msr_pct)");
  EXPECT_EQ(ErrorOf("ed3r-75 <"), "ed3r-75 <:10: expected a number, an arm or a metric, found the end");
  EXPECT_EQ(ErrorOf("rbs < ecd2r > ed3r-75"),
            "rbs < ecd2r > ed3r-75:13: expected only '<' in one chain, found '>'");
  EXPECT_EQ(ErrorOf("(rbs"), "(rbs:5: expected ')', found the end");
  EXPECT_EQ(ErrorOf("rbs ecd2r"), "rbs ecd2r:5: expected end of the claim, found 'ecd2r'");
  EXPECT_EQ(ErrorOf("rbs, ecd2r"), "rbs, ecd2r:11: expected '<', '>' or '~' behind a list, found the end");
  EXPECT_EQ(ErrorOf("ablation-4..1 < rbs"),
            "ablation-4..1 < rbs:13: expected a digit that is larger than the first, found '1'");
  EXPECT_EQ(ErrorOf("ablation-1..7 < rbs"),
            "ablation-1..7 < rbs:1: 'ablation-5' is no arm (nearest: ablation-1)");
  EXPECT_EQ(ErrorOf("1.2.3 < rbs"), "1.2.3 < rbs:1: expected a number, found '1.2.3'");
  EXPECT_NE(ErrorOf("dominated(rbs) ed3r-75"), "");
  EXPECT_NE(ErrorOf("rbs; rbs < ecd2r"), "");
  EXPECT_NE(ErrorOf(""), "");
  EXPECT_NE(ErrorOf("rbs < ecd2r;"), "");
  EXPECT_NE(ErrorOf("rbs & ecd2r"), "");
}

TEST(ExpressionTest, BareArmsNeedAMetric) {
  EXPECT_EQ(ErrorOf("rbs < ecd2r", "pareto"), "rbs < ecd2r:1: 'pareto' is no metric");
  EXPECT_EQ(ErrorOf("frontier(rbs)", "pareto"), "");
}

}  // namespace
}  // namespace ed3r::claims
