// A verdict on every claim of the paper's evaluation, from the missions of one run.
//
//   reproduced          a number: the paper's value lies in our 95 % interval, give or take its rounding, or
//                       within the claim's stated tolerance; an order: it holds (below) and so do the
//                       differences that the paper prints for it; a similarity: the arms differ by less than
//                       its tolerance (below)
//   direction holds     an order, or the sign of a comparison: right with p_Holm < 0.05; its size differs or is
//                       not printed
//   differs             the paper's value is outside our interval and its tolerance; or the opposite order
//                       holds with p_Holm < 0.05
//   not decidable       an order: neither it nor its opposite is significant; a comparison: our interval holds
//                       both the paper's value and no difference at all; a number: its interval holds the
//                       paper's value, but reaches so far that it would hold almost anything (more than half
//                       of that value; for a percentage half of it or of what is missing to 100, or 5 points
//                       if that is more)
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
// of the run, for and against separately.
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "studies/metrics/arm.h"
#include "studies/paper/claims.h"

namespace ed3r {

enum class Verdict {
  kReproduced,
  kDirectionHolds,
  kDiffers,
  kNotDecidable,
  kPaperInconsistent,
  kNotMeasured
};
inline constexpr Verdict kVerdicts[] = {Verdict::kReproduced,        Verdict::kDirectionHolds,
                                        Verdict::kDiffers,           Verdict::kNotDecidable,
                                        Verdict::kPaperInconsistent, Verdict::kNotMeasured};
std::string_view NameOf(Verdict verdict);
// For narrow tables, and what tells their reader which is which.
char LetterOf(Verdict verdict);
inline constexpr std::string_view kVerdictLetters =
    "r reproduced, h direction holds, d differs, u not decidable, i paper inconsistent, n not measured";

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
  std::string why;  // one sentence without a full stop
};

// How `why` starts where arms are missing.
inline constexpr std::string_view kNotInThisRun = "not in this run: ";

struct JudgedClaim {
  Claim claim;
  Judgement all;  // with every mission
  std::vector<Judgement>
      by_network;  // with the missions of one trained network alone; empty with fewer than two
  // A number that differs, though no more than one experiment of the paper's size might by chance: the paper's value
  // lies in the 95 % prediction interval of a single network's (it says nothing of having trained several), or, where no
  // network is asked, of 850 missions.
  bool within_luck = false;
  bool asks_networks =
      false;  // arms of the claim flew several networks: by_network is more than parts of the missions
};

// The verdict as tables tell it: "differs (luck)" where it is within_luck.
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
ClaimStudy JudgeClaims(const std::vector<Claim>& claims, std::span<const ArmData> arms);

std::map<Verdict, int> CountVerdicts(const ClaimStudy& study);
// Claims that are reproduced without a measurement: how the study is set up, how an arm is built, what the paper leaves out.
int CountReproducedByConstruction(const ClaimStudy& study);
// Reproduced numbers that the perception was calibrated on (sweeps/calibration): no prediction.
int CountReproducedByCalibration(const ClaimStudy& study);
// Numbers that differ within the luck of one experiment of the paper's size.
int CountWithinLuck(const ClaimStudy& study);
// Of one claim over the single networks.
std::map<Verdict, int> CountByNetwork(const JudgedClaim& claim);

}  // namespace ed3r
