#include "studies/claims/resampled_arms.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>

#include "engine/core/check.h"
#include "studies/claims/equivalence.h"
#include "studies/paper/arms.h"

namespace ed3r::claims {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

bool IsTotals(metrics::Estimate estimate) {
  return estimate != metrics::Estimate::kMaximum && estimate != metrics::Estimate::kPercentile85;
}

std::set<std::int64_t> NetworksOf(const metrics::ArmData& arm) {
  std::set<std::int64_t> networks;
  for (const mission::MissionRecord& mission : arm.missions) networks.insert(mission.network);
  return networks;
}

std::int64_t TrainedNetworksOf(const metrics::ArmData& arm) {
  const std::set<std::int64_t> networks = NetworksOf(arm);
  return std::count_if(networks.begin(), networks.end(), [](std::int64_t network) { return network >= 0; });
}

const metrics::ArmData* FindArm(const std::vector<const metrics::ArmData*>& arms, std::string_view name) {
  for (const metrics::ArmData* arm : arms)
    if (arm->name == name || paper::P85Name(arm->name) == name) return arm;
  return nullptr;
}

// Of arms of one name the last stage's counts, as in the paper's tables.
bool FliesAgain(const metrics::ArmData& arm, std::span<const metrics::ArmData>::iterator later,
                std::span<const metrics::ArmData>::iterator end) {
  return std::any_of(later, end, [&](const metrics::ArmData& other) {
    return other.name == arm.name && !other.missions.empty();
  });
}

// Whether `name` is the P85 group of an arm with too few missions for one.
bool IsSmallGroup(const metrics::ArmData& arm, const std::string& name) {
  return arm.name != name && metrics::SizeOfP85(arm.missions.size()) < kFewestInP85;
}

// What mission adds to the two totals of a metric. Look-forward accuracy is relative to the worst mission of the arm that the
// network flew (as in the tables), which stays the same in every resample: what is said of it holds for those worst
// missions.
std::pair<double, double> Contribution(const metrics::MetricDefinition& metric,
                                       const mission::MissionRecord& mission,
                                       const metrics::WorstErrors& worst_errors) {
  const double part = metric.part(mission), whole = metric.whole(mission);
  if (metric.estimate != metrics::Estimate::kLookForward) return {whole == 0 ? 0 : part, whole};
  if (whole == 0) return {0, 0};
  const double worst = worst_errors.at(mission.network);
  return {worst > 0 ? 1 - part / whole / worst : 1, 1};
}

// Missions in the order in which a P85 group takes them; in mission order where all count.
std::vector<std::size_t> FillingOrder(const metrics::ArmData& arm, bool is_p85) {
  std::vector<std::size_t> order(arm.missions.size());
  std::iota(order.begin(), order.end(), 0u);
  if (is_p85)
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return arm.missions[a].duration_s > arm.missions[b].duration_s;
    });
  return order;
}

}  // namespace

// One arm or P85 group, laid out for summing: two columns (part, whole) per metric, missions in the order in
// which a P85 group is filled.
struct ResampledArms::View {
  std::string name;
  bool is_p85 = false;
  std::vector<std::size_t> metrics;
  std::vector<int> unit, group;  // of each mission
  std::vector<double> columns;   // missions x (2 x metrics)

  std::size_t width() const { return 2 * metrics.size(); }

  // Totals of the missions, each as often as `count` says; of a P85 group the longest 15 % of those.
  template <class Count>
  void Sum(const Count& count, std::vector<double>& totals) const {
    totals.assign(width(), 0.0);
    std::int64_t left = std::numeric_limits<std::int64_t>::max();
    if (is_p85) {
      std::int64_t all = 0;
      for (std::size_t i = 0; i < unit.size(); ++i) all += count(i);
      left = static_cast<std::int64_t>(metrics::SizeOfP85(static_cast<std::size_t>(all)));
    }
    const std::size_t columns_per_mission = width();
    for (std::size_t i = 0; i < unit.size() && left > 0; ++i) {
      const std::int64_t times = std::min<std::int64_t>(left, count(i));
      if (times == 0) continue;
      left -= times;
      const double* row = columns.data() + i * columns_per_mission;  // of no column nothing is read
      for (std::size_t c = 0; c < columns_per_mission; ++c) totals[c] += static_cast<double>(times) * row[c];
    }
  }

  double ValueOf(std::size_t metric, const std::vector<double>& totals) const {
    const double whole = totals[2 * metric + 1];
    return whole > 0 ? metrics::MetricDefinitions()[metrics[metric]].scale * totals[2 * metric] / whole
                     : kNone;
  }
};

ResampledArms::ResampledArms(std::span<const metrics::ArmData> arms, const std::vector<Cell>& cells) {
  std::set<std::string> names;
  for (const std::string& name : StudyArms()) names.insert(name);
  for (auto arm = arms.begin(); arm != arms.end(); ++arm)
    if (names.count(arm->name) > 0 && !arm->missions.empty() && !FliesAgain(*arm, arm + 1, arms.end()))
      arms_.push_back(&*arm);
  Pair();

  std::map<std::string, std::vector<std::size_t>> wanted;
  for (const Cell& cell : cells)
    if (const metrics::ArmData* arm = FindArm(arms_, cell.arm);
        arm != nullptr && !IsSmallGroup(*arm, cell.arm))
      wanted[cell.arm].push_back(cell.metric);
  std::vector<View> views;
  for (const auto& [name, metrics] : wanted) views.push_back(MakeView(name, metrics));
  Resample(views);
}

ResampledArms::View ResampledArms::MakeView(const std::string& name,
                                            const std::vector<std::size_t>& metrics) {
  const metrics::ArmData& arm = *FindArm(arms_, name);
  View view{name, arm.name != name, {}, {}, {}, {}};
  const metrics::ArmMetrics values = view.is_p85 ? metrics::ComputeP85(arm) : metrics::ComputeMetrics(arm);
  const metrics::WorstErrors worst = metrics::WorstErrorsOf(arm.missions);
  std::set<int> groups;
  for (const mission::MissionRecord& mission : arm.missions)
    groups.insert(group_of_scenario_.at(mission.scenario));
  for (const std::size_t metric : metrics) {
    statistics::Resampled& cell = cells_[{name, metric}];
    cell.value = values.values[metric].value;
    cell.units = static_cast<std::int64_t>(arm.missions.size());
    cell.strata = static_cast<std::int64_t>(groups.size());
    cell.trained = TrainedNetworksOf(arm);
    cell.network_count = NetworksOf(arm).size() > 1 ? networks_ : 1;
    if (!IsTotals(metrics::MetricDefinitions()[metric].estimate)) continue;
    view.metrics.push_back(metric);
  }
  if (!view.is_p85) metrics_.emplace(name, values);
  for (const std::size_t i : FillingOrder(arm, view.is_p85)) {
    const mission::MissionRecord& mission = arm.missions[i];
    view.unit.push_back(unit_of_scenario_.at(mission.scenario));
    view.group.push_back(group_of_scenario_.at(mission.scenario));
    for (std::size_t m = 0; m < view.metrics.size(); ++m) {
      const auto [part, whole] = Contribution(metrics::MetricDefinitions()[view.metrics[m]], mission, worst);
      view.columns.push_back(part), view.columns.push_back(whole);
    }
  }
  return view;
}

void ResampledArms::Pair() {
  const metrics::ArmData* leader = nullptr;
  for (const metrics::ArmData* arm : arms_) {
    const auto count = static_cast<int>(NetworksOf(*arm).size());
    if (leader == nullptr || count > networks_) leader = arm, networks_ = count;
  }
  if (leader == nullptr) return;
  const std::set<std::int64_t> networks = NetworksOf(*leader);
  const auto index = [&](std::int64_t network) {
    return static_cast<int>(std::distance(networks.begin(), networks.find(network)));
  };
  for (const mission::MissionRecord& mission : leader->missions)
    group_of_scenario_[mission.scenario] = index(mission.network);
  for (const metrics::ArmData* arm : arms_) {
    const bool takes_turns = NetworksOf(*arm).size() > 1;
    for (const mission::MissionRecord& mission : arm->missions) {
      // A scenario that the leader has not flown (yet): its own network, or the first one's.
      const auto [found, fresh] = group_of_scenario_.try_emplace(mission.scenario, 0);
      const bool known = networks.count(mission.network) > 0;
      if (fresh && known) found->second = index(mission.network);
      if (takes_turns && (!known || found->second != index(mission.network))) networks_disagree_ = true;
    }
  }
  for (const auto& [scenario, group] : group_of_scenario_)
    unit_of_scenario_.emplace(scenario, static_cast<int>(unit_of_scenario_.size()));
}

void ResampledArms::Resample(const std::vector<View>& views) {
  std::vector<int> group_of_unit;
  for (const auto& [scenario, group] : group_of_scenario_) group_of_unit.push_back(group);
  const statistics::Resampler resampler(group_of_unit, networks_);
  std::vector<std::vector<statistics::Resampled*>> cells;  // of each view, by its metrics
  for (const View& view : views) {
    cells.emplace_back();
    for (const std::size_t metric : view.metrics) cells.back().push_back(&cells_.at({view.name, metric}));
  }
  std::vector<int> missions, networks;
  std::vector<double> totals;
  for (int b = 0; b < kResamples; ++b) {
    resampler.DrawMissions(b, missions);
    if (networks_ > 1) resampler.DrawNetworks(b, networks);
    for (std::size_t v = 0; v < views.size(); ++v) {
      const View& view = views[v];
      view.Sum([&](std::size_t i) { return missions[static_cast<std::size_t>(view.unit[i])]; }, totals);
      for (std::size_t m = 0; m < view.metrics.size(); ++m)
        cells[v][m]->missions.push_back(view.ValueOf(m, totals));
      if (networks_ < 2) continue;
      view.Sum([&](std::size_t i) { return networks[static_cast<std::size_t>(view.group[i])]; }, totals);
      for (std::size_t m = 0; m < view.metrics.size(); ++m)
        cells[v][m]->networks.push_back(view.ValueOf(m, totals));
    }
  }
}

std::vector<std::string> ResampledArms::Missing(const std::vector<Cell>& cells) const {
  std::set<std::string> missing;
  for (const Cell& cell : cells)
    if (cells_.count(cell) == 0)
      missing.insert(FindArm(arms_, cell.arm) == nullptr
                         ? cell.arm
                         : fmt::format("{} of at least {} missions", cell.arm, kFewestInP85));
  return {missing.begin(), missing.end()};
}

statistics::Resampled ResampledArms::Of(const Quantity& quantity) const {
  statistics::Resampled result;
  bool as_many = true;
  for (const Cell& cell : CellsOf(quantity)) {
    const statistics::Resampled& known = cells_.at(cell);
    as_many = as_many && (known.trained == 0 || result.trained == 0 || known.trained == result.trained);
    result.trained = std::max(result.trained, known.trained);
    result.network_count = std::max(result.network_count, known.network_count);
    if (result.units == 0 || known.units - known.strata < result.units - result.strata)
      result.units = known.units, result.strata = known.strata;
  }
  result.value = ValueOf(quantity, [&](const Cell& cell) { return Value(cell); });
  if (!as_many) return result;  // the arms' networks cannot be drawn together: nothing is known of chance
  const auto all = [&](std::vector<double> statistics::Resampled::*level, std::vector<double>& values) {
    // Looked up once: a cell is known by its place in `quantity`.
    std::vector<std::pair<const Cell*, const std::vector<double>*>> known;
    const auto resamples_of = [&](const Cell& cell) -> const std::vector<double>& {
      for (const auto& [place, resamples] : known)
        if (place == &cell) return *resamples;
      return *known.emplace_back(&cell, &(cells_.at(cell).*level)).second;
    };
    for (std::size_t b = 0; b < static_cast<std::size_t>(kResamples); ++b)
      values.push_back(ValueOf(quantity, [&](const Cell& cell) {
        const std::vector<double>& resamples = resamples_of(cell);
        return resamples.empty() ? kNone : resamples[b];
      }));
  };
  all(&statistics::Resampled::missions, result.missions);
  if (result.network_count > 1) all(&statistics::Resampled::networks, result.networks);
  return result;
}

const metrics::MetricValue& ResampledArms::TableValue(const Cell& cell) const {
  return metrics_.at(cell.arm).values[cell.metric];
}

double ResampledArms::ToPaperSize(const std::vector<Cell>& cells) const {
  std::size_t fewest = std::numeric_limits<std::size_t>::max();
  bool groups = false;
  for (const Cell& cell : cells) {
    fewest = std::min(fewest, FindArm(arms_, cell.arm)->missions.size());
    groups = groups || paper::IsP85Name(cell.arm);
  }
  if (cells.empty()) return kNone;
  return groups ? std::sqrt(static_cast<double>(metrics::SizeOfP85(fewest)) / kPaperMissionsInP85)
                : std::sqrt(static_cast<double>(fewest) / kPaperMissions);
}

std::vector<metrics::ArmData> ResampledArms::FlownBy(int network) const {
  std::vector<metrics::ArmData> part;
  for (const metrics::ArmData* arm : arms_) {
    metrics::ArmData& some =
        part.emplace_back(metrics::ArmData{.stage = arm->stage, .name = arm->name, .missions = {}});
    for (const mission::MissionRecord& mission : arm->missions)
      if (group_of_scenario_.at(mission.scenario) == network) some.missions.push_back(mission);
  }
  return part;
}

}  // namespace ed3r::claims
