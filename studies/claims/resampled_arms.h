// The cells that claims are made of, for one run: their values, and what they would have been in each
// resample.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "studies/claims/expression.h"
#include "studies/metrics/arm.h"
#include "studies/metrics/metrics.h"
#include "studies/statistics/resampling.h"

namespace ed3r::claims {

// Enough for percentiles of a 95 % interval; p-values rest on standard deviations, known to 1.6 % then.
inline constexpr int kResamples = 2000;

// A P85 group of fewer missions says nothing that can be held against the paper's, of 128.
inline constexpr std::size_t kFewestInP85 = 20;

// The arms of the paper among `arms`, by name (the first of a name that has missions), without copies.
// "ed3r-p85" and its like stand for the P85 group of their arm: in every resample its longest missions anew.
class ResampledArms {
 public:
  // Resamples every one of `cells` whose arm is there. `arms` must outlive this.
  ResampledArms(std::span<const metrics::ArmData> arms, const std::vector<Cell>& cells);

  // The arms of `cells` that the run does not have, or has too few missions of for a P85 group; each once.
  std::vector<std::string> Missing(const std::vector<Cell>& cells) const;

  double Value(const Cell& cell) const { return cells_.at(cell).value; }
  const statistics::Resampled& At(const Cell& cell) const { return cells_.at(cell); }
  // Without resamples where arms of it flew different numbers of networks.
  statistics::Resampled Of(const Quantity& quantity) const;

  // As ComputeMetrics gives it, for the arms themselves; P85 groups have none (their interval must know that
  // the group is chosen by what happened: use At).
  const metrics::MetricValue& TableValue(const Cell& cell) const;

  // Turns a standard error over the missions at hand into one over as many as the paper flew: of the arm of `cells` with the
  // fewest; of a P85 group over as many as the paper's seems to have had.
  double ToPaperSize(const std::vector<Cell>& cells) const;

  int networks() const { return networks_; }                     // 1 where none or one flew
  bool networks_disagree() const { return networks_disagree_; }  // see FlownBy
  std::size_t scenarios() const { return group_of_scenario_.size(); }

  // The arms with only the missions of scenarios that network number `network` flew (0 .. networks()-1).
  // Which network flew a scenario is what the arm with the most networks says; arms of another rotation are
  // paired with it by scenario all the same.
  std::vector<metrics::ArmData> FlownBy(int network) const;

 private:
  struct View;
  void Pair();
  View MakeView(const std::string& name, const std::vector<std::size_t>& metrics);
  void Resample(const std::vector<View>& views);

  std::vector<const metrics::ArmData*> arms_;  // those of the paper that the run has
  std::map<std::int64_t, int> group_of_scenario_, unit_of_scenario_;
  int networks_ = 1;
  bool networks_disagree_ = false;
  std::map<Cell, statistics::Resampled> cells_;
  std::map<std::string, metrics::ArmMetrics> metrics_;
};

}  // namespace ed3r::claims
