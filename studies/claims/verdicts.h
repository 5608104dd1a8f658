// A verdict on every claim of the paper's evaluation, from the missions of one run.
//
//   equivalent          a number, or the size of a comparison: ours is the paper's within the margin (studies/claims/
//                       equivalence.h: 10 % of a size, 5 points of a percentage), give or take the chance of both experiments
//   imprecise           compatible, but the interval of the difference reaches beyond the margin
//   reproduced          an order: it holds (below) and so, within the margin, do the differences that the paper prints for
//                       it; a similarity: the arms differ by less than its tolerance (below); how the study is made
//   direction holds     an order, or the sign of a comparison: right with p_Holm < 0.05; its size is not equivalent or is
//                       not printed
//   differs             a number, or the size of a comparison whose sign is not certain: the interval of the difference does
//                       not hold zero; or the opposite order holds with p_Holm < 0.05
//   not decidable       an order: neither it nor its opposite is significant
//   paper inconsistent  the paper contradicts itself here (the arithmetic is in `why`); ours is given all the
//                       same
//   not measured        no run can show it, or arms are missing from this one, or it is too short (P85 groups) or
//                       of another length (numbers of missions)
//
// Numbers of one arm have the interval of the tables (studies/metrics), so that a verdict and a table never
// disagree. Everything that compares arms, and P85 groups, which are chosen by what happened (so that the
// groups of resamples differ too), rest on paired resampling at two levels (studies/statistics/resampling.h).
// A claim with several parts is as certain as its least certain part; one with alternatives ("dominated by one
// of") pays for each of them (Bonferroni). p-values are corrected by Holm over all different directional claims
// of the run, for and against separately. The paper makes some claims several times: each is counted once.
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "studies/metrics/arm.h"
#include "studies/paper/claims.h"

namespace ed3r::claims {

enum class Verdict {
  kReproduced,
  kEquivalent,
  kDirectionHolds,
  kImprecise,
  kDiffers,
  kNotDecidable,
  kPaperInconsistent,
  kNotMeasured
};
inline constexpr Verdict kVerdicts[] = {
    Verdict::kReproduced, Verdict::kEquivalent,   Verdict::kDirectionHolds,    Verdict::kImprecise,
    Verdict::kDiffers,    Verdict::kNotDecidable, Verdict::kPaperInconsistent, Verdict::kNotMeasured};
std::string_view NameOf(Verdict verdict);
// Reproduced, equivalent, or right in direction.
bool Holds(Verdict verdict);
// For narrow tables, and what tells their reader which is which.
char LetterOf(Verdict verdict);
inline constexpr std::string_view kVerdictLetters =
    "r reproduced, e equivalent, h direction holds, c imprecise, d differs, u not decidable, i paper "
    "inconsistent, n not "
    "measured";

// NaN is "none". For an order, `ours` and `paper` are the difference in its least certain part, positive where
// it is as claimed, and that part stands in `why`.
struct Judgement {
  Verdict verdict = Verdict::kNotMeasured;
  double ours = std::numeric_limits<double>::quiet_NaN();
  double lo = std::numeric_limits<double>::quiet_NaN();
  double hi = std::numeric_limits<double>::quiet_NaN();
  double paper = std::numeric_limits<double>::quiet_NaN();
  double p = std::numeric_limits<double>::quiet_NaN();  // of what is claimed; none for numbers of one arm
  double p_against = std::numeric_limits<double>::quiet_NaN();  // of the opposite
  double p_holm = std::numeric_limits<double>::quiet_NaN();
  double p_against_holm = std::numeric_limits<double>::quiet_NaN();
  // Numbers and comparisons: ours minus the paper's with 95 %, and the margin of equivalence; none otherwise.
  double difference_lo = std::numeric_limits<double>::quiet_NaN();
  double difference_hi = std::numeric_limits<double>::quiet_NaN();
  double margin = std::numeric_limits<double>::quiet_NaN();
  // Standard error of ours over the missions at hand, and over as many as the paper flew; the luck of training is in neither.
  double own_sd = std::numeric_limits<double>::quiet_NaN();
  double paper_sd = std::numeric_limits<double>::quiet_NaN();
  std::int64_t missions = 0;  // of the arm with the fewest; 0 where nothing rests on missions
  std::string why;            // one sentence without a full stop
};

// Whether the luck of training may explain a number that differs (studies/claims/luck.h).
enum class Luck { kNone, kWithin, kTooWide, kUnknown };
std::string_view NameOf(Luck luck);

// How `why` starts where arms are missing.
inline constexpr std::string_view kNotInThisRun = "not in this run: ";

struct JudgedClaim {
  paper::Claim claim;
  Judgement all;  // with every mission
  std::vector<Judgement>
      by_network;  // with the missions of one trained network alone; empty with fewer than two
  Luck luck = Luck::kNone;
  bool asks_networks =
      false;  // arms of the claim flew several networks: by_network is more than parts of the missions
  std::string repeats;  // an earlier claim that says the same of the same; mostly empty
};

// The verdict as tables tell it: "differs (luck)" where one network of the paper may differ so, "differs (luck?)" where
// networks spread too widely to tell.
std::string NameWithLuck(const JudgedClaim& judged);

struct ClaimStudy {
  std::vector<JudgedClaim> claims;  // in the order of the paper's list
  int family = 0;                   // different directional claims that p values are corrected for
  int networks = 0;                 // 1: intervals and p-values know nothing of the luck of training
  bool networks_disagree = false;   // arms took turns among their networks differently
  std::int64_t scenarios = 0;
  bool HasArms() const { return scenarios > 0; }
};

// Judges `claims` by those of `arms` that bear the paper's names. Throws UserError where a comparison does not
// parse. Deterministic; 1.1 s for nine arms of 850 missions with five networks, 7 s for 10,000 missions.
ClaimStudy JudgeClaims(const std::vector<paper::Claim>& claims, std::span<const metrics::ArmData> arms);

// Every different claim once.
std::map<Verdict, int> CountVerdicts(const ClaimStudy& study);
int CountDistinct(const ClaimStudy& study);
// Claims that are reproduced without a measurement: how the study is set up, how an arm is built, what the paper leaves out.
int CountReproducedByConstruction(const ClaimStudy& study);
// Equivalent numbers that the world was calibrated on (sweeps/calibration): no prediction.
int CountCalibrated(const ClaimStudy& study);
// Numbers that differ no more than one network of the paper may.
int CountWithinLuck(const ClaimStudy& study);
// Of one claim over the single networks.
std::map<Verdict, int> CountByNetwork(const JudgedClaim& claim);

}  // namespace ed3r::claims
