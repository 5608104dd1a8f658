// Verdicts on synthetic runs whose truth is known.
#include "studies/claims/verdicts.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

#include "engine/core/check.h"
#include "tests/claims/synthetic_run.h"

namespace ed3r::claims {
namespace {

paper::Claim Value(const std::string& arm, const std::string& metric, const std::string& value,
                   const std::string& unit) {
  return {.id = "V",
          .where = "",
          .strategy = arm,
          .metric = metric,
          .kind = "value",
          .paper_value = value,
          .unit = unit,
          .source = "printed",
          .comparison = "",
          .tolerance = 0,
          .exact_words = "",
          .inconsistent = "",
          .unmeasured = "",
          .note = ""};
}

paper::Claim Energy(const std::string& arm, const std::string& value) {
  return Value(arm, "total_energy_kj", value, "kJ");
}

paper::Claim Order(const std::string& comparison, double tolerance = 0) {
  paper::Claim claim = Energy("", "");
  claim.kind = "order", claim.comparison = comparison, claim.tolerance = tolerance;
  return claim;
}

paper::Claim Reduction(const std::string& comparison, const std::string& percent) {
  paper::Claim claim = Order("100*(1 - " + comparison + ")");
  claim.kind = "ratio", claim.paper_value = percent, claim.unit = "% reduction";
  return claim;
}

JudgedClaim JudgeOne(const paper::Claim& claim, const std::vector<metrics::ArmData>& arms) {
  return JudgeClaims({claim}, arms).claims.front();
}

Verdict VerdictOf(const paper::Claim& claim, const std::vector<metrics::ArmData>& arms) {
  return JudgeOne(claim, arms).all.verdict;
}

std::vector<metrics::ArmData> ThreeArms() {
  return {MakeArm({"ed3r-75", 20}), MakeArm({"ecd2r", 25}), MakeArm({"rbs", 35, 0.2, 0, false})};
}

// Many missions, little luck: known well.
std::vector<metrics::ArmData> WellKnown() {
  SyntheticDesign many;
  many.missions = 4200;
  return {MakeArm({"ed3r-75", 20}, many), MakeArm({"rbs", 35, 0.2, 0, false}, many)};
}

TEST(VerdictsTest, NumbersOfOneArm) {
  const std::vector<metrics::ArmData> arms = WellKnown();
  const Judgement same = JudgeOne(Energy("ed3r-75", "20.1"), arms).all;
  EXPECT_EQ(same.verdict, Verdict::kEquivalent);
  EXPECT_NEAR(same.margin, 2.01, 1e-9);
  EXPECT_LT(same.difference_lo, same.ours - 20.1);
  EXPECT_GT(same.difference_hi, same.ours - 20.1);
  const Judgement far = JudgeOne(Energy("ed3r-75", "30"), arms).all;
  EXPECT_EQ(far.verdict, Verdict::kDiffers);
  EXPECT_NEAR(far.ours, 20, 0.7);
  EXPECT_LT(far.difference_hi, 0);
  EXPECT_TRUE(std::isnan(far.p_holm));
  EXPECT_NE(far.why.find("ours - paper = -"), std::string::npos);
}

// 20 kJ with a spread of 6 (hardness 0.5 to 1.5): 850 missions of the paper leave +- 0.4, so the difference is known no better
// than that, however many missions we fly.
TEST(VerdictsTest, ThePapersOwnChanceCounts) {
  const Judgement judged = JudgeOne(Energy("ed3r-75", "20"), WellKnown()).all;
  EXPECT_NEAR(judged.paper_sd, 6.0 / std::sqrt(850.0), 0.03);
  EXPECT_NEAR(judged.own_sd, 6.0 / std::sqrt(4200.0), 0.02);
  EXPECT_GT(judged.difference_hi - judged.difference_lo, 2 * 1.96 * judged.paper_sd);
}

TEST(VerdictsTest, ToleranceIsTheMarginWhereWordsAreVague) {
  const std::vector<metrics::ArmData> arms = ThreeArms();
  paper::Claim claim = Energy("ed3r-75", "24");
  EXPECT_EQ(VerdictOf(claim, arms), Verdict::kDiffers);
  claim.tolerance = 6;
  EXPECT_EQ(VerdictOf(claim, arms), Verdict::kEquivalent);
  claim.tolerance = 3;
  EXPECT_EQ(VerdictOf(claim, arms), Verdict::kDiffers);
}

// A maximum has no interval: only the margin can hold it. It grows with the number of missions.
TEST(VerdictsTest, NumbersWithoutAnInterval) {
  SyntheticDesign design;
  design.missions = 850;  // as many as in the paper
  const std::vector<metrics::ArmData> arms = {MakeArm({"ed3r-75", 20}, design)};
  EXPECT_EQ(VerdictOf(Value("ed3r-75", "duration_max_min", "4", "min"), ThreeArms()), Verdict::kNotMeasured);
  paper::Claim claim =
      Value("ed3r-75", "duration_max_min", "3.3", "min");  // 20 kJ x 1.5 at 130 W, and noise: 3.9 or more
  EXPECT_EQ(VerdictOf(claim, arms), Verdict::kDiffers);
  claim.tolerance = 2;
  EXPECT_EQ(VerdictOf(claim, arms), Verdict::kEquivalent);
}

TEST(VerdictsTest, AWideIntervalNeverMakesANumberAgree) {
  const std::vector<metrics::ArmData> lucky = {MakeArm({"ed3r-75", 20, 0, 0.9})};
  EXPECT_EQ(VerdictOf(Energy("ed3r-75", "20"), lucky), Verdict::kImprecise);
  EXPECT_EQ(VerdictOf(Energy("ed3r-75", "80"), lucky), Verdict::kDiffers);
}

TEST(VerdictsTest, SharesOfMissionsArePercentagesToo) {
  const std::vector<metrics::ArmData> arms = {MakeArm({"ed3r-75", 100, 0, 0.3})};  // 10 minutes take 78 kJ
  const JudgedClaim judged = JudgeOne(Value("ed3r-75", "within_10min_pct", "30", "% of missions"), arms);
  EXPECT_EQ(judged.all.margin, 5.0);
  EXPECT_EQ(judged.all.verdict, Verdict::kImprecise) << judged.all.why;
}

TEST(VerdictsTest, OneNetworkOfThePaperMayDifferFromOurMean) {
  const std::vector<metrics::ArmData> arms = {MakeArm({"ed3r-75", 20, 0, 0.2}),
                                              MakeArm({"rbs", 20, 0, 0, false})};
  // Networks of 16, 18, 20, 22, 24 kJ: s = 3.16; one more lies within t(4) x 3.16 x sqrt(1 + 1/5) = 9.6 of their mean.
  for (const auto& [paper, luck] :
       {std::tuple("26", Luck::kTooWide), std::tuple("28", Luck::kTooWide), std::tuple("31", Luck::kNone)}) {
    const JudgedClaim judged = JudgeOne(Energy("ed3r-75", paper), arms);
    EXPECT_EQ(judged.all.verdict, Verdict::kDiffers) << paper;
    EXPECT_EQ(judged.luck, luck) << paper;  // 19 kJ of band against margins of 2.6 to 3.1
  }
  // Networks of 19.2 to 20.8 kJ: a band of 3.9 and what 56 missions of a network leave, less than four margins of 2.3.
  const std::vector<metrics::ArmData> alike = {MakeArm({"ed3r-75", 20, 0, 0.04})};
  EXPECT_EQ(JudgeOne(Energy("ed3r-75", "23"), alike).luck, Luck::kNone);
  EXPECT_EQ(JudgeOne(Energy("rbs", "22"), arms).luck, Luck::kUnknown) << "no network, no luck of training";
}

TEST(VerdictsTest, ValuesThatDoNotExist) {
  const std::vector<metrics::ArmData> arms = ThreeArms();  // no network predicts anything in them
  EXPECT_EQ(VerdictOf(Value("rbs", "lf_accuracy_pct", "n/a", ""), arms), Verdict::kReproduced);
  EXPECT_EQ(VerdictOf(Value("rbs", "lf_accuracy_pct", "75", "%"), arms), Verdict::kNotMeasured);
  EXPECT_EQ(VerdictOf(Value("rbs", "msr_pct", "n/a", ""), arms), Verdict::kDiffers);
}

TEST(VerdictsTest, Orders) {
  const std::vector<metrics::ArmData> arms = ThreeArms();
  EXPECT_EQ(VerdictOf(Order("ed3r-75 < ecd2r < rbs"), arms), Verdict::kDirectionHolds);
  EXPECT_EQ(VerdictOf(Order("rbs < ed3r-75"), arms), Verdict::kDiffers);
  EXPECT_EQ(VerdictOf(Order("ed3r-75 < ecd2r; rbs < ecd2r"), arms), Verdict::kDiffers);
}

TEST(VerdictsTest, AnOrderIsAsCertainAsItsLeastCertainPart) {
  const std::vector<metrics::ArmData> arms = {MakeArm({"ed3r-75", 20}), MakeArm({"ecd2r", 20.6}),
                                              MakeArm({"rbs", 35})};
  const Judgement judged = JudgeOne(Order("ed3r-75 < ecd2r < rbs"), arms).all;
  EXPECT_EQ(judged.p, JudgeOne(Order("ed3r-75 < ecd2r"), arms).all.p);
  EXPECT_NEAR(judged.ours, 0.6, 0.3);
  EXPECT_NE(judged.why.find("ed3r-75 < ecd2r"), std::string::npos);
}

TEST(VerdictsTest, OfPartsThatLeanTheOtherWayTheSurerIsShown) {
  const std::vector<metrics::ArmData> arms = {MakeArm({"ed3r-75", 20}), MakeArm({"ecd2r", 19.8}),
                                              MakeArm({"rbs", 10})};
  const Judgement judged = JudgeOne(Order("ed3r-75 < ecd2r, rbs"), arms).all;
  EXPECT_NEAR(judged.ours, -10, 1);
  EXPECT_NE(judged.why.find("ed3r-75 < rbs"), std::string::npos) << judged.why;
}

TEST(VerdictsTest, AnOrderWithItsPrintedSizesIsReproduced) {
  SyntheticDesign many;
  many.missions = 4200;
  const std::vector<metrics::ArmData> arms = {MakeArm({"ed3r-75", 20}, many), MakeArm({"ecd2r", 25}, many)};
  EXPECT_EQ(JudgeClaims({Order("ed3r-75 < ecd2r"), Energy("ed3r-75", "20"), Energy("ecd2r", "25")}, arms)
                .claims[0]
                .all.verdict,
            Verdict::kReproduced);
  EXPECT_EQ(JudgeClaims({Order("ed3r-75 < ecd2r"), Energy("ed3r-75", "20"), Energy("ecd2r", "60")}, arms)
                .claims[0]
                .all.verdict,
            Verdict::kDirectionHolds);
}

TEST(VerdictsTest, TiesAreNotDecidable) {
  metrics::ArmData twin = MakeArm({"ed3r-75", 20});
  twin.name = "ecd2r";
  const JudgedClaim judged = JudgeOne(Order("ed3r-75 < ecd2r"), {MakeArm({"ed3r-75", 20}), twin});
  EXPECT_EQ(judged.all.verdict, Verdict::kNotDecidable);
  EXPECT_EQ(judged.all.ours, 0);
  EXPECT_EQ(judged.all.p, 1);
  EXPECT_EQ(VerdictOf(Order("ed3r-75 ~ ecd2r", 0.5), {MakeArm({"ed3r-75", 20}), twin}), Verdict::kReproduced);
}

// What two networks' luck may do cannot be drawn together with that of five.
TEST(VerdictsTest, ArmsOfDifferentNumbersOfNetworksAreNotDecided) {
  const metrics::ArmData five = MakeArm({"ed3r-75", 20}), two = MakeArm({"ecd2r", 40}, {.networks = 2});
  const Judgement judged = JudgeOne(Order("ed3r-75 < ecd2r"), {five, two}).all;
  EXPECT_EQ(judged.verdict, Verdict::kNotDecidable);
  EXPECT_EQ(judged.p, 1);
  const metrics::ArmData as_many = MakeArm({"ecd2r", 40});
  EXPECT_NE(JudgeOne(Order("ed3r-75 < ecd2r"), {five, as_many}).all.verdict, Verdict::kNotDecidable);
}

TEST(VerdictsTest, Similarities) {
  const std::vector<metrics::ArmData> arms = ThreeArms();
  EXPECT_EQ(VerdictOf(Order("ed3r-75 ~ ecd2r", 9), arms), Verdict::kReproduced);
  EXPECT_EQ(VerdictOf(Order("ed3r-75 ~ ecd2r", 1), arms), Verdict::kDiffers);
  EXPECT_EQ(VerdictOf(Order("ed3r-75 ~ ecd2r", 5), arms), Verdict::kNotDecidable);
}

TEST(VerdictsTest, Comparisons) {
  const std::vector<metrics::ArmData> arms = ThreeArms();
  EXPECT_EQ(VerdictOf(Reduction("ed3r-75 / ecd2r", "20"), arms), Verdict::kEquivalent);
  EXPECT_EQ(VerdictOf(Reduction("ed3r-75 / ecd2r", "60"), arms), Verdict::kDirectionHolds);
  EXPECT_EQ(VerdictOf(Reduction("ecd2r / ed3r-75", "20"), arms), Verdict::kDiffers);
  // Luck of 30 % either way: the interval holds 20 % and much else.
  const std::vector<metrics::ArmData> lucky = {MakeArm({"ed3r-75", 20, 0, 0.3}), MakeArm({"ecd2r", 25})};
  EXPECT_EQ(VerdictOf(Reduction("ed3r-75 / ecd2r", "20"), lucky), Verdict::kImprecise);
}

// A reduction that the paper prints and an increase that is certain: within the margin or not, that is no agreement.
TEST(VerdictsTest, AComparisonWhoseOppositeIsCertainDiffers) {
  const SyntheticDesign quiet{.missions = 4200, .networks = 1, .places = 28, .own_noise = 0.01};
  const std::vector<metrics::ArmData> arms = {MakeArm({"ed3r-75", 20.4}, quiet),
                                              MakeArm({"ecd2r", 20}, quiet)};
  const Judgement judged = JudgeOne(Reduction("ed3r-75 / ecd2r", "1"), arms).all;
  EXPECT_EQ(judged.verdict, Verdict::kDiffers);
  EXPECT_NE(judged.why.find("the opposite is significant"), std::string::npos) << judged.why;
}

TEST(VerdictsTest, PointsArePercentages) {
  paper::Claim claim = Reduction("ed3r-75 / rbs", "20");
  claim.metric = "msr_pct", claim.comparison = "ed3r-75 - rbs", claim.unit = "points";
  EXPECT_EQ(JudgeOne(claim, ThreeArms()).all.margin, 5.0);
}

// 10 % of the difference that the paper prints, not of the numbers that it is made of.
TEST(VerdictsTest, AnOrderIsReproducedByItsDifferences) {
  SyntheticDesign many;
  many.missions = 4200;
  many.own_noise = 0.01;
  const std::vector<metrics::ArmData> arms = {MakeArm({"ed3r-75", 20}, many), MakeArm({"ecd2r", 25}, many)};
  const auto verdict = [&](const std::string& ecd2r) {
    return JudgeClaims({Order("ed3r-75 < ecd2r"), Energy("ed3r-75", "20"), Energy("ecd2r", ecd2r)}, arms)
        .claims[0]
        .all.verdict;
  };
  EXPECT_EQ(verdict("25.0"), Verdict::kReproduced);
  EXPECT_EQ(verdict("24.0"), Verdict::kDirectionHolds);  // 5 kJ of difference for 4
}

TEST(VerdictsTest, ThePapersChanceInSharesIsThatOfItsOwnMissions) {
  const std::vector<metrics::ArmData> arms = ThreeArms();
  const Judgement all = JudgeOne(Value("rbs", "msr_pct", "76.82", "%"), arms).all;
  EXPECT_NEAR(all.paper_sd, 100 * std::sqrt(0.7682 * 0.2318 / 850), 1e-9);
  const Judgement p85 = JudgeOne(Value("rbs-p85", "msr_pct", "73.44", "%"), arms).all;
  EXPECT_NEAR(p85.paper_sd, 100 * std::sqrt(0.7344 * 0.2656 / 64), 1e-9);
  // No failure of ours wastes nothing; a tenth of the paper's energy was wasted all the same.
  const Judgement wasted = JudgeOne(Value("ed3r-75", "wer_pct", "10.26", "%"), arms).all;
  EXPECT_EQ(wasted.ours, 0);
  EXPECT_NEAR(wasted.paper_sd, 100 * std::sqrt(0.1026 * 0.8974 / 850), 1e-9);
}

TEST(VerdictsTest, PairingMakesSmallDifferencesCertain) {
  // Hardness varies by a third between missions, an arm's own noise is small: 1 % of difference shows only in
  // pairs.
  const SyntheticDesign quiet{.missions = 280, .networks = 1, .places = 28, .own_noise = 0.01};
  const metrics::ArmData first = MakeArm({"ed3r-75", 20}, quiet);
  metrics::ArmData second = MakeArm({"ecd2r", 20.2}, quiet);
  EXPECT_EQ(VerdictOf(Order("ed3r-75 < ecd2r"), {first, second}), Verdict::kDirectionHolds);
  for (mission::MissionRecord& mission : second.missions)
    mission.scenario += 10000;  // other scenarios: nothing is shared
  EXPECT_EQ(VerdictOf(Order("ed3r-75 < ecd2r"), {first, second}), Verdict::kNotDecidable);
}

TEST(VerdictsTest, LuckOfTrainingUndoesWhatOneNetworkShows) {
  const SyntheticArm lucky{"ed3r-75", 20, 0, 0.4}, other{"ecd2r", 22};
  SyntheticDesign single;
  single.networks = 1;
  const JudgedClaim one =
      JudgeOne(Order("ed3r-75 < ecd2r"), {MakeArm(lucky, single), MakeArm(other, single)});
  EXPECT_EQ(one.all.verdict, Verdict::kDirectionHolds);
  EXPECT_TRUE(one.by_network.empty());

  const JudgedClaim five = JudgeOne(Order("ed3r-75 < ecd2r"), {MakeArm(lucky), MakeArm(other)});
  EXPECT_EQ(five.all.verdict, Verdict::kNotDecidable);
  // 12, 16, 20, 24, 28 kJ against 22.
  ASSERT_EQ(five.by_network.size(), 5u);
  EXPECT_EQ(CountByNetwork(five),
            (std::map<Verdict, int>{{Verdict::kDirectionHolds, 3}, {Verdict::kDiffers, 2}}));
  EXPECT_NEAR(five.by_network[0].ours, 10, 1.5);
  EXPECT_NEAR(five.by_network[4].ours, -6, 1.5);
}

TEST(VerdictsTest, ArmsWithoutNetworksKnowNoLuckOfTraining) {
  const std::vector<metrics::ArmData> arms = ThreeArms();
  const Judgement rbs = JudgeOne(Energy("rbs-p85", "40"), arms).all;
  SyntheticDesign single;
  single.networks = 1;
  const Judgement alone =
      JudgeOne(Energy("rbs-p85", "40"), {MakeArm({"rbs", 35, 0.2, 0, false}, single)}).all;
  EXPECT_EQ(rbs.ours, alone.ours);
  EXPECT_NEAR(rbs.hi - rbs.lo, alone.hi - alone.lo, 0.25 * (alone.hi - alone.lo));
}

TEST(VerdictsTest, P85GroupsAreTheLongestMissions) {
  const std::vector<metrics::ArmData> arms = ThreeArms();
  const Judgement judged = JudgeOne(Energy("ed3r-p85", "28.5"), arms).all;
  EXPECT_EQ(judged.verdict, Verdict::kEquivalent);  // hardness 1.35 to 1.5
  EXPECT_NEAR(judged.ours, 28.5, 0.5);
  EXPECT_LT(judged.lo, judged.ours);
  EXPECT_GT(judged.hi, judged.ours);
  EXPECT_EQ(VerdictOf(Reduction("ed3r-p85 / rbs-p85", "42.9"), arms), Verdict::kEquivalent);
}

TEST(VerdictsTest, SmallP85GroupsAreNotMeasured) {
  SyntheticDesign design;
  design.missions = 129;
  const Judgement small = JudgeOne(Energy("ed3r-p85", "28.5"), {MakeArm({"ed3r-75", 20}, design)}).all;
  EXPECT_EQ(small.verdict, Verdict::kNotMeasured);
  EXPECT_EQ(small.why, "not in this run: ed3r-p85 of at least 20 missions");
  design.missions = 130;  // 19.5
  EXPECT_NE(VerdictOf(Energy("ed3r-p85", "28.5"), {MakeArm({"ed3r-75", 20}, design)}), Verdict::kNotMeasured);
}

TEST(VerdictsTest, Frontiers) {
  std::vector<metrics::ArmData> arms;
  for (const char* name : {"ablation-1", "ablation-2", "ablation-3", "ablation-4", "ecd2r", "rbs"})
    arms.push_back(MakeArm({name, 40, 0.5}));
  arms.push_back(MakeArm({"ed3r-65", 10, 0.3}));
  arms.push_back(MakeArm({"ed3r-75", 20, 0.02}));
  arms.push_back(MakeArm({"ed3r-85", 30, 0.3}));
  EXPECT_EQ(VerdictOf(Order("dominated(rbs, ablation-1..4) by ed3r-65, ed3r-75"), arms),
            Verdict::kDirectionHolds);
  EXPECT_EQ(VerdictOf(Order("dominated(ed3r-75) by ed3r-85, rbs"), arms), Verdict::kDiffers);
  EXPECT_EQ(VerdictOf(Order("frontier(ed3r-65, ed3r-75)"), arms), Verdict::kDirectionHolds);
  EXPECT_EQ(VerdictOf(Order("frontier(ed3r-85)"), arms), Verdict::kDiffers);
}

TEST(VerdictsTest, WhatThePaperContradictsIsNotHeldAgainstUs) {
  paper::Claim claim = Energy("ed3r-75", "30");
  claim.inconsistent = "it says 21 elsewhere";
  const Judgement judged = JudgeOne(claim, ThreeArms()).all;
  EXPECT_EQ(judged.verdict, Verdict::kPaperInconsistent);
  EXPECT_EQ(judged.why, "it says 21 elsewhere");
  EXPECT_NEAR(judged.ours, 20, 0.7);
}

TEST(VerdictsTest, WhatIsNotThereIsNotMeasured) {
  paper::Claim never = Order("");
  never.unmeasured = "a choice";
  EXPECT_EQ(JudgeOne(never, ThreeArms()).all.why, "a choice");
  const Judgement judged = JudgeOne(Order("ed3r-75 < ablation-1..2"), ThreeArms()).all;
  EXPECT_EQ(judged.verdict, Verdict::kNotMeasured);
  EXPECT_EQ(judged.why, "not in this run: ablation-1, ablation-2");
  EXPECT_TRUE(std::isnan(judged.ours));
}

TEST(VerdictsTest, EmptyArmsAndEmptyRuns) {
  std::vector<metrics::ArmData> arms = ThreeArms();
  arms[1].missions.clear();
  EXPECT_EQ(VerdictOf(Order("ed3r-75 < ecd2r"), arms), Verdict::kNotMeasured);
  EXPECT_EQ(VerdictOf(Order("ed3r-75 < rbs"), arms), Verdict::kDirectionHolds);
  const ClaimStudy nothing = JudgeClaims(paper::PaperClaims(), {});
  EXPECT_FALSE(nothing.HasArms());
  EXPECT_EQ(nothing.claims.size(), paper::PaperClaims().size());
  // One mission has no interval: nothing is decided, nothing breaks.
  SyntheticDesign one;
  one.missions = 1;
  const std::vector<metrics::ArmData> tiny = {MakeArm({"ed3r-75", 20}, one), MakeArm({"ecd2r", 90}, one)};
  EXPECT_NO_THROW(JudgeClaims(paper::PaperClaims(), tiny));
  const Judgement judged = JudgeOne(Energy("ed3r-75", "20"), tiny).all;
  EXPECT_EQ(judged.verdict, Verdict::kNotMeasured);
  EXPECT_NE(judged.why.find("too few missions"), std::string::npos) << judged.why;
}

TEST(VerdictsTest, RepeatedClaimsAreOneQuestion) {
  const std::vector<metrics::ArmData> arms = ThreeArms();
  const std::vector<paper::Claim> once = {Order("ed3r-75 < ecd2r"), Order("ecd2r < rbs")};
  std::vector<paper::Claim> often = once;
  for (int i = 0; i < 50; ++i) often.push_back(once[0]);
  EXPECT_EQ(JudgeClaims(once, arms).claims[1].all.p_holm, JudgeClaims(often, arms).claims[1].all.p_holm);
}

TEST(VerdictsTest, RepeatedClaimsCountOnce) {
  paper::Claim again = Energy("ed3r-75", "30");
  again.id = "W";
  paper::Claim other = Energy("ed3r-75", "31");
  other.id = "X";
  const ClaimStudy study = JudgeClaims({Energy("ed3r-75", "30"), again, other}, ThreeArms());
  EXPECT_EQ(study.claims[1].repeats, "V");
  EXPECT_TRUE(study.claims[2].repeats.empty());
  EXPECT_EQ(CountDistinct(study), 2);
  EXPECT_EQ(CountVerdicts(study), (std::map<Verdict, int>{{Verdict::kDiffers, 2}}));
}

TEST(VerdictsTest, AnOrderReadFromTheOtherSideIsTheSameQuestion) {
  paper::Claim flipped = Order("rbs > ecd2r; total_energy_kj(ecd2r) > total_energy_kj(ed3r-75)");
  flipped.id = "W";
  const ClaimStudy study =
      JudgeClaims({Order("ed3r-75 < ecd2r < rbs"), flipped, Order("rbs < ecd2r")}, ThreeArms());
  EXPECT_EQ(study.claims[1].repeats, "V");
  EXPECT_TRUE(study.claims[2].repeats.empty());
  EXPECT_EQ(study.family, 2);
}

TEST(VerdictsTest, UnreadableClaimsAreErrors) {
  EXPECT_THROW(JudgeClaims({Order("ed3r-75 is best")}, ThreeArms()), UserError);
}

TEST(VerdictsTest, ArmsOfOtherRotationsArePairedAndNamed) {
  SyntheticDesign other;
  other.places = 14;
  const ClaimStudy study =
      JudgeClaims({Order("ed3r-75 < ecd2r")},
                  std::vector<metrics::ArmData>{MakeArm({"ed3r-75", 20}), MakeArm({"ecd2r", 25}, other)});
  EXPECT_TRUE(study.networks_disagree);
  EXPECT_EQ(study.claims[0].all.verdict, Verdict::kDirectionHolds);
  EXPECT_FALSE(JudgeClaims({Order("ed3r-75 < ecd2r")}, ThreeArms()).networks_disagree);
}

// As the paper's tables do.
TEST(VerdictsTest, OfArmsOfOneNameTheLastStagesCounts) {
  std::vector arms = {MakeArm({"ed3r-75", 40}), MakeArm({"ecd2r", 25}), MakeArm({"ed3r-75", 20})};
  arms[0].stage = "first";
  EXPECT_EQ(VerdictOf(Order("ed3r-75 < ecd2r"), arms), Verdict::kDirectionHolds);
  EXPECT_NEAR(JudgeOne(Energy("ed3r-75", "20"), arms).all.ours, 20, 2);
  arms[2].missions.clear();  // planned, not flown yet
  EXPECT_NEAR(JudgeOne(Energy("ed3r-75", "20"), arms).all.ours, 40, 4);
}

TEST(VerdictsTest, AreTheSameEveryTime) {
  const std::vector<metrics::ArmData> arms = ThreeArms();
  const ClaimStudy a = JudgeClaims(paper::PaperClaims(), arms), b = JudgeClaims(paper::PaperClaims(), arms);
  for (std::size_t i = 0; i < a.claims.size(); ++i) {
    EXPECT_EQ(a.claims[i].all.verdict, b.claims[i].all.verdict);
    if (!std::isnan(a.claims[i].all.lo)) {
      EXPECT_EQ(a.claims[i].all.lo, b.claims[i].all.lo);
    }
  }
}

}  // namespace
}  // namespace ed3r::claims
