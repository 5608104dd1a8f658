// The claims as data against the paper's own numbers: an expression that was written down wrongly would not
// hold where the paper's numbers are put in.
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <sstream>

#include "studies/claims/expression.h"
#include "studies/metrics/definitions.h"
#include "studies/paper/claims.h"

namespace ed3r::claims {
namespace {

double Printed(const Cell& cell) {
  const auto paper =
      paper::FindPaperValue(paper::PaperClaims(), cell.arm, metrics::MetricDefinitions()[cell.metric].name);
  return paper ? paper->value : std::nan("");
}

bool AllPrinted(const Expression& expression) {
  for (const Cell& cell : CellsOf(expression))
    if (std::isnan(Printed(cell))) return false;
  return true;
}

bool IsJudgedByExpression(const paper::Claim& claim) {
  return claim.kind != "setup" && claim.unmeasured.empty();
}

Expression Parse(const paper::Claim& claim) {
  return ParseExpression(claim.comparison.empty() ? claim.strategy : claim.comparison, claim.metric);
}

TEST(PaperArithmeticTest, EveryClaimParses) {
  for (const paper::Claim& claim : paper::PaperClaims()) {
    if (!IsJudgedByExpression(claim)) continue;
    const Expression expression = Parse(claim);
    EXPECT_EQ(expression.is_quantity, claim.kind != "order") << claim.id;
    EXPECT_FALSE(CellsOf(expression).empty()) << claim.id;
  }
}

TEST(PaperArithmeticTest, EveryOrderHoldsInThePapersNumbers) {
  int checked = 0;
  for (const paper::Claim& claim : paper::PaperClaims()) {
    if (claim.kind != "order" || !IsJudgedByExpression(claim)) continue;
    const Expression expression = Parse(claim);
    if (!AllPrinted(expression)) continue;
    ++checked;
    // A similarity is read as "within the printed spread", which the printed numbers just reach.
    EXPECT_TRUE(Holds(expression.formula, claim.tolerance + 1e-9, Printed)) << claim.id;
  }
  EXPECT_EQ(checked, 34);
}

TEST(PaperArithmeticTest, EveryComparisonFollowsFromThePapersNumbers) {
  int checked = 0;
  for (const paper::Claim& claim : paper::PaperClaims()) {
    if (claim.kind != "ratio" || !AllPrinted(Parse(claim))) continue;
    ++checked;
    const double value = ValueOf(Parse(claim).quantity, Printed);
    const paper::PaperValue paper = *paper::PaperValueOf(claim);
    // Half a unit of rounding in the ratio, and what 21.33 for 21.44 kJ makes of it.
    const bool follows = std::abs(value - paper.value) <= paper.half_unit + 0.36;
    EXPECT_EQ(follows, claim.inconsistent.empty()) << claim.id << ' ' << value;
  }
  EXPECT_EQ(checked, 17);
}

TEST(PaperArithmeticTest, StrategiesAreArms) {
  const std::set<std::string> arms(StudyArms().begin(), StudyArms().end());
  for (const paper::Claim& claim : paper::PaperClaims()) {
    if (claim.kind == "setup") continue;
    std::istringstream words(claim.strategy);
    for (std::string arm; words >> arm;) EXPECT_EQ(arms.count(arm), 1u) << claim.id << ' ' << arm;
  }
}

// The arithmetic in the rows that are marked as inconsistent.
TEST(PaperArithmeticTest, InconsistenciesAreReal) {
  EXPECT_NEAR(0.1031 * 21.33, 0.1026 * 21.44, 0.005);
  EXPECT_EQ(std::lround((1 - 0.7656) * 128), 30);
  EXPECT_EQ(std::lround((1 - 0.9718) * 850), 24);
  EXPECT_NEAR(100 * (1 - 10.26 / 25.32), 59.5, 0.05);
  int marked = 0;
  for (const paper::Claim& claim : paper::PaperClaims()) marked += claim.inconsistent.empty() ? 0 : 1;
  EXPECT_EQ(marked, 6);
}

}  // namespace
}  // namespace ed3r::claims
