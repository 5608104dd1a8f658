#include <fmt/format.h>

#include "engine/core/files/end_mark.h"
#include "studies/perception/profile_fit.h"

namespace ed3r::perception_fit {
namespace {

const char* ModelName(bool quantized) { return quantized ? "Quantized" : "Full"; }

std::string ResponseText(const char* name, const ResponseFit& fit) {
  const ResponseConfig& r = fit.response;
  return fmt::format(
      "{:<10} {:>11.3g} {:>7.2f} {:>8.3f} {:>11.2f} {:>12.2f} {:>8} {:>6.3f} {:>10.2f} {:>8.1f} {:>9.1f} "
      "{:>7.1f} {:>10.1f}\n",
      name, r.half_signal, r.slope, r.ceiling, r.view_sigma, r.frame_sigma, fit.periods, fit.rms_residual,
      fit.variance_explained, fit.same_decision_pct, fit.always_no_pct, fit.recall_pct, fit.precision_pct);
}

nlohmann::ordered_json ResponseJson(const ResponseFit& fit) {
  const ResponseConfig& r = fit.response;
  return {{"half_signal", r.half_signal},
          {"slope", r.slope},
          {"ceiling", r.ceiling},
          {"view_sigma", r.view_sigma},
          {"frame_sigma", r.frame_sigma},
          {"periods", fit.periods},
          {"rms_residual", fit.rms_residual},
          {"variance_explained", fit.variance_explained},
          {"same_decision_pct", fit.same_decision_pct},
          {"always_no_pct", fit.always_no_pct},
          {"recall_pct", fit.recall_pct},
          {"precision_pct", fit.precision_pct}};
}

}  // namespace

std::string ProfileFitText(const ProfileFit& fit) {
  std::string text = fmt::format(
      "Response of the fast tier fitted to what the networks said; weights against flame: smoke {:.3g}, "
      "distractors "
      "{:.3g}\n\n{:<10} {:>11} {:>7} {:>8} {:>11} {:>12} {:>8} {:>6} {:>10} {:>8} {:>9} {:>7} {:>10}\n",
      fit.smoke_weight, fit.distractor_weight, "model", "half signal", "slope", "ceiling", "view sigma",
      "frame sigma", "periods", "RMS", "explained", "same, %", "never, %", "recall", "precision");
  text += ResponseText("Full", fit.full) + ResponseText("Quantized", fit.quantized);
  text +=
      "\nPeriods of missions that were not fitted. same: profile and networks both say fire, or both not; "
      "never: what "
      "'never fire'\nwould reach; recall: of what the networks call fire; precision: of what the profile "
      "calls fire.\n";
  text += fmt::format("Both tiers agree on whether fire is in view in {:.1f} % of the periods.\n",
                      fit.same_truth_pct);
  text += fmt::format("\n{:<10} {:>22} {:>8} {:>10} {:>10}\n", "model", "signal (image share)", "periods",
                      "observed", "expected");
  for (const AgreementBand& band : fit.bands)
    text += fmt::format("{:<10} {:>22} {:>8} {:>10.3f} {:>10.3f}\n", ModelName(band.quantized),
                        band.signal_from == 0.0
                            ? std::string("none")
                            : fmt::format("{:.0e} .. {:.0e}", band.signal_from, band.signal_to),
                        band.periods, band.observed, band.expected);
  text +=
      fmt::format("\nPeriods without fire in view that are reliable, %\n{:<16} {:>8} {:>10} {:>15} {:>19}\n",
                  "camera tilt", "periods", "networks", "fitted profile", "configured profile");
  for (const FalseAlarmBand& band : fit.false_alarms)
    text += fmt::format("{:<16} {:>8} {:>10.2f} {:>15.2f} {:>19.2f}\n",
                        fmt::format("{:.0f} .. {:.0f} deg", band.tilt_from_deg, band.tilt_to_deg),
                        band.periods, band.networks_pct, band.fitted_pct, band.configured_pct);
  return text;
}

nlohmann::ordered_json ProfileFitJson(const ProfileFit& fit) {
  nlohmann::ordered_json bands = nlohmann::ordered_json::array();
  for (const AgreementBand& band : fit.bands)
    bands.push_back({{"model", ModelName(band.quantized)},
                     {"signal_from", band.signal_from},
                     {"signal_to", band.signal_to},
                     {"periods", band.periods},
                     {"observed", band.observed},
                     {"expected", band.expected}});
  nlohmann::ordered_json alarms = nlohmann::ordered_json::array();
  for (const FalseAlarmBand& band : fit.false_alarms)
    alarms.push_back({{"tilt_from_deg", band.tilt_from_deg},
                      {"tilt_to_deg", band.tilt_to_deg},
                      {"periods", band.periods},
                      {"networks_pct", band.networks_pct},
                      {"fitted_profile_pct", band.fitted_pct},
                      {"configured_profile_pct", band.configured_pct}});
  return {{"smoke_weight", fit.smoke_weight},
          {"distractor_weight", fit.distractor_weight},
          {"full", ResponseJson(fit.full)},
          {"quantized", ResponseJson(fit.quantized)},
          {"same_truth_pct", fit.same_truth_pct},
          {"bands", bands},
          {"false_alarms", alarms}};
}

std::string ProfileFitYaml(const ProfileFit& fit, const std::string& made_from) {
  std::string yaml =
      fmt::format("# Fast tier fitted to the pixel tier by 'ed3r fit --perception' from {}.\n{}\n", made_from,
                  kEndAnnounced);
  yaml += fmt::format("perception:\n  fire_weight: 1\n  smoke_weight: {:.4g}\n  distractor_weight: {:.4g}\n",
                      fit.smoke_weight, fit.distractor_weight);
  for (const auto& [name, response] : {std::pair{"full", fit.full}, std::pair{"quantized", fit.quantized}}) {
    const ResponseConfig& r = response.response;
    yaml += fmt::format(
        "  {}: {{half_signal: {:.4g}, slope: {:.4g}, ceiling: {:.4g}, view_sigma: {:.4g}, frame_sigma: "
        "{:.4g}, distractor_gain: {:g}}}\n",
        name, r.half_signal, r.slope, r.ceiling, r.view_sigma, r.frame_sigma, r.distractor_gain);
  }
  return yaml + kEndMark + "\n";
}

std::string LooksCsv(std::span<const PeriodLook> looks, const ProfileFit& fit) {
  std::string csv = "model,fire_share,smoke_share,distractor_share,observed,expected,residual\n";
  for (std::size_t i = 0; i < looks.size(); ++i)
    csv += fmt::format("{},{},{},{},{},{},{}\n", ModelName(looks[i].quantized), looks[i].fire_share,
                       looks[i].smoke_share, looks[i].distractor_share, looks[i].mean, fit.expected[i],
                       looks[i].mean - fit.expected[i]);
  return csv;
}

}  // namespace ed3r::perception_fit
