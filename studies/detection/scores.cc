#include "studies/detection/scores.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>

#include "engine/core/check.h"
#include "studies/detection/roc_area.h"
#include "studies/detection/views.h"

namespace ed3r::detection {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

double Auc(std::span<const double> confidences, std::span<const FrameLabel> labels,
           const std::vector<std::size_t>& chosen) {
  const std::vector<int> one_unit(chosen.size(), 0), once = {1};
  return RocArea(confidences, labels, chosen, one_unit).Of(once);
}

double CalibrationError(std::span<const double> confidences, std::span<const FrameLabel> labels,
                        const std::vector<std::size_t>& chosen) {
  constexpr std::size_t kBins = 10;
  double confidence[kBins] = {}, positive[kBins] = {};
  for (const std::size_t i : chosen) {
    const std::size_t bin = std::min(kBins - 1, static_cast<std::size_t>(confidences[i] * kBins));
    confidence[bin] += confidences[i];
    positive[bin] += labels[i].positive ? 1.0 : 0.0;
  }
  double sum = 0.0;
  for (std::size_t b = 0; b < kBins; ++b) sum += std::abs(confidence[b] - positive[b]);
  return chosen.empty() ? kNan : sum / static_cast<double>(chosen.size());
}

statistics::Interval AccuracyInterval(std::span<const double> confidences, std::span<const FrameLabel> labels,
                                      const std::vector<std::size_t>& chosen) {
  const Views views = ViewsOf(labels, chosen);
  std::vector<double> right(static_cast<std::size_t>(views.count)), frames(right.size());
  for (std::size_t c = 0; c < chosen.size(); ++c) {
    const auto view = static_cast<std::size_t>(views.of_frame[c]);
    right[view] += (confidences[chosen[c]] >= kDecision) == labels[chosen[c]].positive ? 1.0 : 0.0;
    frames[view] += 1.0;
  }
  return statistics::ShareInterval(right, frames, statistics::ShareUnit::kTimestep);
}

// Positives by `value` in [edges[b], edges[b + 1]), each band with all negatives; bands without positives are left out.
std::vector<Group> Bands(std::span<const FrameLabel> labels, const std::vector<double>& edges,
                         const std::function<double(const FrameLabel&)>& value,
                         const std::function<std::string(double, double)>& name) {
  std::vector<Group> groups;
  for (std::size_t b = 0; b + 1 < edges.size(); ++b) {
    Group group{.name = name(edges[b], edges[b + 1]), .frames = {}};
    bool any = false;
    for (std::size_t i = 0; i < labels.size(); ++i) {
      const double v = value(labels[i]);
      const bool inside = v >= edges[b] && v < edges[b + 1];
      if (labels[i].positive && !inside) continue;
      any = any || labels[i].positive;
      group.frames.push_back(i);
    }
    if (any) groups.push_back(std::move(group));
  }
  return groups;
}

}  // namespace

DetectionScores ScoresOf(std::span<const double> confidences, std::span<const FrameLabel> labels,
                         const std::vector<std::size_t>& chosen) {
  ED3R_CHECK(confidences.size() == labels.size(), "one confidence per frame");
  DetectionScores scores;
  for (const std::size_t i : chosen) {
    const bool said = confidences[i] >= kDecision;
    if (labels[i].positive)
      ++(said ? scores.true_positives : scores.false_negatives);
    else
      ++(said ? scores.false_positives : scores.true_negatives);
  }
  scores.auc = Auc(confidences, labels, chosen);
  scores.accuracy =
      chosen.empty() ? kNan
                     : static_cast<double>(scores.true_positives + scores.true_negatives) / scores.Frames();
  scores.accuracy_interval = AccuracyInterval(confidences, labels, chosen);
  scores.calibration_error = CalibrationError(confidences, labels, chosen);
  return scores;
}

Group All(std::span<const FrameLabel> labels) {
  Group all{.name = "all", .frames = {}};
  for (std::size_t i = 0; i < labels.size(); ++i) all.frames.push_back(i);
  return all;
}

std::vector<Group> ByDistance(std::span<const FrameLabel> labels) {
  return Bands(
      labels, {0, 50, 100, 150, 200, 300, kInfinity}, [](const FrameLabel& l) { return l.distance_m; },
      [](double low, double high) {
        return high < kInfinity ? fmt::format("{:g} .. {:g} m", low, high) : fmt::format("from {:g} m", low);
      });
}

std::vector<Group> ByOcclusion(std::span<const FrameLabel> labels) {
  return Bands(
      labels, {0, 0.1, 0.5, 0.9, kInfinity}, [](const FrameLabel& l) { return l.occluded; },
      [](double low, double high) {
        return fmt::format("{:g} .. {:g} % hidden", 100 * low, 100 * std::min(high, 1.0));
      });
}

std::vector<Group> BySize(std::span<const FrameLabel> labels) {
  return Bands(
      labels, {0, 8, 32, 128, 512, kInfinity}, [](const FrameLabel& l) { return l.fire_px + l.smoke_px; },
      [](double low, double high) {
        return high < kInfinity ? fmt::format("{:g} .. {:g} px", low, high - 1)
                                : fmt::format("from {:g} px", low);
      });
}

std::vector<Group> ByWorld(std::span<const FrameLabel> labels) {
  std::map<std::string, Group> worlds;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    Group& group = worlds[labels[i].world];
    group.name = labels[i].world;
    group.frames.push_back(i);
  }
  std::vector<Group> groups;
  for (auto& [name, group] : worlds) groups.push_back(std::move(group));
  return groups;
}

}  // namespace ed3r::detection
