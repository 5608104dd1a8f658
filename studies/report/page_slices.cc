#include "studies/report/page_slices.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "engine/core/check.h"
#include "studies/figures/mission_columns.h"

namespace ed3r::report {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr int kBins = 50;

Json Exact(double value) { return std::isnan(value) ? Json(nullptr) : Json(value); }

Json Row(const metrics::ArmMetrics& metrics, bool whole) {
  if (metrics.missions == 0) return nullptr;
  Json row = {metrics.missions};
  for (std::size_t m = 0; m < metrics.values.size(); ++m) {
    const metrics::MetricValue& value = metrics.values[m];
    const bool relative = metrics::MetricDefinitions()[m].estimate == metrics::Estimate::kLookForward;
    for (const double number : {value.value, value.lo, value.hi})
      row.push_back(whole ? Exact(number) : relative ? Json(nullptr) : figures::Rounded(number));
  }
  return row;
}

std::set<std::int64_t> SitesOf(std::span<const metrics::ArmData> arms) {
  std::set<std::int64_t> sites;
  for (const metrics::ArmData& arm : arms)
    for (const mission::MissionRecord& mission : arm.missions) sites.insert(mission.site);
  return sites;
}

template <class Wanted>
Json Slice(std::span<const metrics::ArmData> arms, const Wanted& wanted) {
  Json rows = Json::array();
  for (const metrics::ArmData& arm : arms) {
    metrics::ArmData part{arm.stage, arm.name, {}};
    std::copy_if(arm.missions.begin(), arm.missions.end(), std::back_inserter(part.missions), wanted);
    rows.push_back(part.missions.empty() ? Json(nullptr)
                                         : Row(metrics::ComputeMetrics(part), /*whole=*/false));
  }
  return rows;
}

template <class Place>
void AddPlace(std::span<const metrics::ArmData> arms, const std::string& name, bool outcomes,
              const Place& there, Json& slices) {
  if (name != "all") slices[name + "|all"] = Slice(arms, there);
  for (std::int64_t outcome = 0; outcomes && outcome < 3; ++outcome)
    slices[name + '|' + std::to_string(outcome)] =
        Slice(arms, [&](const mission::MissionRecord& m) { return there(m) && m.outcome == outcome; });
}

double EnergyKj(const mission::MissionRecord& m) { return m.total_j / 1000; }
double DurationMin(const mission::MissionRecord& m) { return m.duration_s / 60; }
double ScsPct(const mission::MissionRecord& m) {
  return m.reliable_timesteps > 0 ? 100 * m.reliable_scs_sum / static_cast<double>(m.reliable_timesteps)
                                  : kNone;
}

struct Scale {
  const char *column, *label, *unit;
  double (*value)(const mission::MissionRecord&);
  bool from_zero;
};
constexpr Scale kScales[] = {{"energy_kj", "energy", "kJ", EnergyKj, true},
                             {"duration_min", "duration", "min", DurationMin, true},
                             {"scs_pct", "mean confidence of reliable looks", "%", ScsPct, false}};

struct Range {
  double from = 0, step = 1;
  int BinOf(double value) const {
    return std::clamp(static_cast<int>(std::floor((value - from) / step)), 0, kBins - 1);
  }
};

Range RangeOf(std::span<const metrics::ArmData> arms, const Scale& scale) {
  double lo = std::numeric_limits<double>::infinity(), hi = -lo;
  for (const metrics::ArmData& arm : arms)
    for (const mission::MissionRecord& mission : arm.missions)
      if (const double value = scale.value(mission); !std::isnan(value))
        lo = std::min(lo, value), hi = std::max(hi, value);
  if (hi < lo) return {};
  const double from = scale.from_zero ? std::min(0.0, std::floor(lo)) : std::floor(lo);
  const double width = std::max(std::ceil(hi) - from, 1.0);
  return {from, width / kBins};
}

const char* CauseOf(const mission::MissionRecord& mission) {
  if (mission.outcome == static_cast<std::int64_t>(mission::Outcome::kFalsePositive))
    return "false alarm: it was sure of a fire, but what it saw was not the fire";
  return mission.reliable_timesteps == 0 ? "battery empty without one reliable look"
                                         : "battery empty, some reliable looks but never enough in a row";
}

// Missions of an arm that failed from the same cause.
class FailureGroup {
 public:
  void Add(int number, const mission::MissionRecord& mission, bool list_each_site) {
    ++count_;
    known_ += mission.site_known != 0;
    const std::size_t there = static_cast<std::size_t>(++sites_[mission.site]);
    if (missions_.size() >= kMostFailuresListed && !(list_each_site && there <= kFailuresListedPerSite))
      return;
    missions_.push_back({number, mission.site, figures::Rounded(EnergyKj(mission), 2),
                         figures::Rounded(DurationMin(mission), 2), mission.timesteps,
                         mission.reliable_timesteps});
  }
  Json ToJson(std::size_t arm, const std::string& cause, std::int64_t outcome) && {
    Json sites = Json::object();
    for (const auto& [site, count] : sites_) sites[std::to_string(site)] = count;
    return {{"arm", arm},
            {"cause", cause},
            {"outcome", outcome},
            {"count", count_},
            {"known", known_},
            {"sites", std::move(sites)},
            {"missions", std::move(missions_)}};
  }

 private:
  int count_ = 0, known_ = 0;
  std::map<std::int64_t, int> sites_;
  Json missions_ = Json::array();
};

}  // namespace

Json SlicesJson(std::span<const metrics::ArmData> arms, std::span<const metrics::ArmMetrics> metrics) {
  ED3R_CHECK(arms.size() == metrics.size(), "metrics of every arm");
  Json slices = Json::object();
  Json& whole = slices["all|all"] = Json::array();
  for (const metrics::ArmMetrics& arm : metrics) whole.push_back(Row(arm, /*whole=*/true));
  const auto known = [](bool wanted) {
    return [wanted](const mission::MissionRecord& m) { return (m.site_known != 0) == wanted; };
  };
  AddPlace(
      arms, "all", true, [](const mission::MissionRecord&) { return true; }, slices);
  AddPlace(arms, "known", true, known(true), slices);
  AddPlace(arms, "unseen", true, known(false), slices);
  const std::set<std::int64_t> sites = SitesOf(arms);
  for (const std::int64_t site : sites)
    AddPlace(
        arms, std::to_string(site), sites.size() <= kMostSites,
        [&](const mission::MissionRecord& m) { return m.site == site; }, slices);
  return slices;
}

Json HistogramsJson(std::span<const metrics::ArmData> arms) {
  Json json = {{"scales", Json::array()}, {"cells", Json::array()}};
  for (std::size_t s = 0; s < std::size(kScales); ++s) {
    const Scale& scale = kScales[s];
    const Range range = RangeOf(arms, scale);
    json["scales"].push_back({{"column", scale.column},
                              {"label", scale.label},
                              {"unit", scale.unit},
                              {"from", range.from},
                              {"step", range.step},
                              {"bins", kBins}});
    for (std::size_t a = 0; a < arms.size(); ++a) {
      std::map<std::pair<std::int64_t, std::int64_t>, std::array<int, kBins>> cells;
      for (const mission::MissionRecord& mission : arms[a].missions)
        if (const double value = scale.value(mission); !std::isnan(value))
          ++cells[{mission.site, mission.outcome}][static_cast<std::size_t>(range.BinOf(value))];
      for (const auto& [place, counts] : cells) {
        const auto filled = [](int n) { return n > 0; };
        const auto first = std::find_if(counts.begin(), counts.end(), filled);
        const auto last = std::find_if(counts.rbegin(), counts.rend(), filled).base();
        Json cell = {a, place.first, place.second, s, first - counts.begin()};
        for (auto count = first; count != last; ++count) cell.push_back(*count);
        json["cells"].push_back(std::move(cell));
      }
    }
  }
  return json;
}

Json PointsJson(std::span<const metrics::ArmData> arms, std::span<const std::vector<int>> numbers) {
  Json json = Json::array();
  for (std::size_t a = 0; a < arms.size(); ++a) {
    const std::vector<mission::MissionRecord>& missions = arms[a].missions;
    ED3R_CHECK(numbers[a].size() == missions.size(), "a number for every mission");
    const int last = missions.empty() ? 0 : numbers[a].back();
    const int every = last / kMostPoints + 1;
    Json columns = {{"every", every}};
    for (const char* column :
         {"number", "site", "outcome", "network", "energy_kj", "duration_min", "scs_pct"})
      columns[column] = Json::array();
    for (std::size_t i = 0; i < missions.size(); ++i) {
      if (numbers[a][i] % every != 0) continue;
      const mission::MissionRecord& mission = missions[i];
      columns["number"].push_back(numbers[a][i]);
      columns["site"].push_back(mission.site);
      columns["outcome"].push_back(mission.outcome);
      columns["network"].push_back(mission.network);
      columns["energy_kj"].push_back(figures::Rounded(EnergyKj(mission), 2));
      columns["duration_min"].push_back(figures::Rounded(DurationMin(mission), 2));
      columns["scs_pct"].push_back(figures::Rounded(ScsPct(mission), 1));
    }
    json.push_back(std::move(columns));
  }
  return json;
}

Json FailuresJson(std::span<const metrics::ArmData> arms, std::span<const std::vector<int>> numbers) {
  const bool list_each_site = SitesOf(arms).size() <= kMostSites;
  Json groups = Json::array();
  for (std::size_t a = 0; a < arms.size(); ++a) {
    ED3R_CHECK(numbers[a].size() == arms[a].missions.size(), "a number for every mission");
    std::map<std::pair<std::string, std::int64_t>, FailureGroup> by_cause;
    for (std::size_t i = 0; i < arms[a].missions.size(); ++i) {
      const mission::MissionRecord& mission = arms[a].missions[i];
      if (mission.outcome == static_cast<std::int64_t>(mission::Outcome::kSuccess)) continue;
      by_cause[{CauseOf(mission), mission.outcome}].Add(numbers[a][i], mission, list_each_site);
    }
    for (auto& [cause, group] : by_cause)
      groups.push_back(std::move(group).ToJson(a, cause.first, cause.second));
  }
  return groups;
}

}  // namespace ed3r::report
