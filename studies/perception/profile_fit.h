// The fast tier (perception.tier profile) fitted to timesteps that real networks looked at (pixels): which response of
// geometry predicts what they said?
//
// For a sensing period with visible shares a (engine/perception/view.h) the profile expects the mean confidence
//   E = integral over z' from logit(t / ceiling) of  ceiling / (1 + exp(-z'))  phi((z' - z) / sigma) / sigma
//   z = slope log10(s / half_signal),  s = the stronger of a_fire + w_smoke a_smoke and w_distractor a_distractor,
//   sigma^2 = view_sigma^2 + frame_sigma^2,  t = frame_threshold: frames below it count as 0 (R33).
// Ceres minimises the squared differences to the observed means and to how often a period is reliable (kReliable), so that
// the fitted profile is right on average: confidences are bounded, and those far off are no errors but views that the
// geometry does not tell apart. Both models at once, as they share the weights. frame_sigma comes from the spread within
// periods whose frames all lie above the threshold. Of more than kMostFitted periods of a model every n-th is fitted.
//
// Pure functions of their arguments, any thread.
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "engine/config/perception.h"

namespace ed3r::perception_fit {

// One sensing period of a mission in the pixel tier, and what the fast tier's geometry sees from the same pose.
struct PeriodLook {
  bool quantized = false;                                              // which model looked
  double tilt_rad = 0.0;                                               // of the camera, below level
  double fire_share = 0.0, smoke_share = 0.0, distractor_share = 0.0;  // geometry
  double mean = 0.0, deviation = 0.0;                                  // of the frames' confidences, observed
  bool fire_in_view_pixels = false, fire_in_view_geometry = false;
  bool held_out = false;  // judged, not fitted
};

// Figures are over the periods held out, where there are any.
struct ResponseFit {
  ResponseConfig response;
  int periods = 0;
  double rms_residual = 0.0;        // of the mean confidence
  double variance_explained = 0.0;  // 1 - residual sum of squares / total
  double same_decision_pct = 0.0;   // expected and observed mean on the same side of frame_threshold
  double always_no_pct = 0.0;       // what "never fire" would reach
  double recall_pct = 0.0;          // of the periods that the networks call fire
  double precision_pct = 0.0;       // of those that the profile calls fire
};

// Periods of similar signal, expected against observed.
struct AgreementBand {
  bool quantized = false;
  double signal_from = 0.0, signal_to = 0.0;  // [from, to)
  int periods = 0;
  double observed = 0.0, expected = 0.0;  // means of the mean confidence
};

// Periods without fire in view in either tier: how often are they reliable (mean confidence from kReliable on)?
struct FalseAlarmBand {
  double tilt_from_deg = 0.0, tilt_to_deg = 0.0;  // [from, to), the last one closed
  int periods = 0;
  double networks_pct = 0.0, fitted_pct = 0.0,
         configured_pct = 0.0;  // observed; expected of two profiles
};

struct ProfileFit {
  double smoke_weight = 0.0, distractor_weight = 0.0;  // fire_weight is 1
  ResponseFit full, quantized;
  std::vector<AgreementBand> bands;
  std::vector<FalseAlarmBand> false_alarms;
  double same_truth_pct = 0.0;   // periods in which both tiers agree whether fire is in view (R16)
  std::vector<double> expected;  // one per look
};

inline constexpr int kMostFitted = 10000;
// The paper's middle threshold, eta_min.
inline constexpr double kReliable = 0.75;

// `start`: where the search begins, the thresholds, and the profile that the false alarms are compared with.
// Throws UserError where a model looked at fewer than 50 periods with some signal, or nothing can be fitted at this threshold.
ProfileFit FitProfile(std::span<const PeriodLook> looks, const PerceptionConfig& start);

// What the profile with this configuration expects of a look.
double ExpectedConfidence(const PeriodLook& look, const PerceptionConfig& perception);

// How likely this profile makes the mean of a look reliable.
double AlarmProbability(const PeriodLook& look, const PerceptionConfig& perception);

std::string ProfileFitText(const ProfileFit& fit);
nlohmann::ordered_json ProfileFitJson(const ProfileFit& fit);
// Parameters for a sweep's `set`.
std::string ProfileFitYaml(const ProfileFit& fit, const std::string& made_from);
// Columns model,fire_share,smoke_share,distractor_share,observed,expected,residual.
std::string LooksCsv(std::span<const PeriodLook> looks, const ProfileFit& fit);

}  // namespace ed3r::perception_fit
