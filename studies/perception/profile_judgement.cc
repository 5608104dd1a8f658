#include "studies/perception/profile_judgement.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ed3r::perception_fit {
namespace {

double SignalOf(const PeriodLook& look, const ProfileFit& fit) {
  return std::max(look.fire_share + fit.smoke_weight * look.smoke_share,
                  fit.distractor_weight * look.distractor_share);
}

double Percent(int part, int whole) { return whole > 0 ? 100.0 * part / whole : std::nan(""); }

// Figures of one model over the periods that were not fitted, or over all where none was held back.
void Judge(std::span<const PeriodLook> looks, bool quantized, double threshold,
           const std::vector<double>& expected, ResponseFit& fit) {
  const bool held_out =
      std::any_of(looks.begin(), looks.end(), [](const PeriodLook& l) { return l.held_out; });
  double squares = 0.0, sum = 0.0, total = 0.0;
  int same = 0, said = 0, foretold = 0, both = 0;
  for (std::size_t i = 0; i < looks.size(); ++i) {
    const PeriodLook& look = looks[i];
    if (look.quantized != quantized || (held_out && !look.held_out)) continue;
    ++fit.periods;
    squares += (look.mean - expected[i]) * (look.mean - expected[i]);
    sum += look.mean;
    total += look.mean * look.mean;
    const bool networks = look.mean >= threshold, profile = expected[i] >= threshold;
    same += networks == profile ? 1 : 0;
    said += networks ? 1 : 0;
    foretold += profile ? 1 : 0;
    both += networks && profile ? 1 : 0;
  }
  fit.rms_residual = std::sqrt(squares / fit.periods);
  fit.variance_explained = 1.0 - squares / (total - sum * sum / fit.periods);
  fit.same_decision_pct = Percent(same, fit.periods);
  fit.always_no_pct = Percent(fit.periods - said, fit.periods);
  fit.recall_pct = Percent(both, said);
  fit.precision_pct = Percent(both, foretold);
}

std::vector<AgreementBand> Bands(std::span<const PeriodLook> looks, const ProfileFit& fit) {
  std::vector<AgreementBand> bands;
  const double edges[] = {0.0, 1e-12, 1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2, 1e-1, 1e3};
  for (const bool quantized : {false, true}) {
    for (std::size_t b = 0; b + 1 < std::size(edges); ++b) {
      AgreementBand band{quantized, edges[b], edges[b + 1]};
      for (std::size_t i = 0; i < looks.size(); ++i) {
        const double signal = SignalOf(looks[i], fit);
        if (looks[i].quantized != quantized || signal < edges[b] || signal >= edges[b + 1]) continue;
        ++band.periods;
        band.observed += looks[i].mean;
        band.expected += fit.expected[i];
      }
      if (band.periods == 0) continue;
      band.observed /= band.periods;
      band.expected /= band.periods;
      bands.push_back(band);
    }
  }
  return bands;
}

std::vector<FalseAlarmBand> FalseAlarms(std::span<const PeriodLook> looks, const PerceptionConfig& fitted,
                                        const PerceptionConfig& configured) {
  constexpr int kBands = 9;
  constexpr double kBandDeg = 10.0;
  std::vector<FalseAlarmBand> bands(kBands);
  for (const PeriodLook& look : looks) {
    if (look.fire_in_view_pixels || look.fire_in_view_geometry) continue;
    const double tilt_deg = look.tilt_rad * 180.0 / std::numbers::pi;
    FalseAlarmBand& band =
        bands[static_cast<std::size_t>(std::clamp(static_cast<int>(tilt_deg / kBandDeg), 0, kBands - 1))];
    ++band.periods;
    band.networks_pct += look.mean >= kReliable ? 100.0 : 0.0;
    band.fitted_pct += 100.0 * AlarmProbability(look, fitted);
    band.configured_pct += 100.0 * AlarmProbability(look, configured);
  }
  for (std::size_t b = 0; b < bands.size(); ++b) {
    bands[b].tilt_from_deg = kBandDeg * static_cast<double>(b);
    bands[b].tilt_to_deg = bands[b].tilt_from_deg + kBandDeg;
    for (double* share : {&bands[b].networks_pct, &bands[b].fitted_pct, &bands[b].configured_pct})
      *share /= std::max(1, bands[b].periods);
  }
  return bands;
}

}  // namespace

void JudgeFit(std::span<const PeriodLook> looks, const PerceptionConfig& configured, ProfileFit& fit) {
  PerceptionConfig fitted = configured;
  fitted.fire_weight = 1.0;
  fitted.smoke_weight = fit.smoke_weight;
  fitted.distractor_weight = fit.distractor_weight;
  fitted.full = fit.full.response;
  fitted.quantized = fit.quantized.response;
  int same_truth = 0;
  for (const PeriodLook& look : looks) {
    fit.expected.push_back(ExpectedConfidence(look, fitted));
    same_truth += look.fire_in_view_pixels == look.fire_in_view_geometry ? 1 : 0;
  }
  fit.same_truth_pct = Percent(same_truth, static_cast<int>(looks.size()));
  Judge(looks, false, configured.frame_threshold, fit.expected, fit.full);
  Judge(looks, true, configured.frame_threshold, fit.expected, fit.quantized);
  fit.bands = Bands(looks, fit);
  fit.false_alarms = FalseAlarms(looks, fitted, configured);
}

}  // namespace ed3r::perception_fit
