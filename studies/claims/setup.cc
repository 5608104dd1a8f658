#include "studies/claims/setup.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "engine/core/check.h"
#include "engine/rfnn/features.h"
#include "studies/claims/expression.h"
#include "studies/metrics/metrics.h"
#include "studies/paper/arms.h"

namespace ed3r::claims {
namespace {

const metrics::ArmData* FindWarmup(std::span<const metrics::ArmData> arms) {
  const auto found = std::find_if(arms.begin(), arms.end(), [](const metrics::ArmData& arm) {
    return arm.name == "warmup" && !arm.missions.empty();
  });
  return found == arms.end() ? nullptr : &*found;
}

bool IsOnline(const metrics::ArmData& arm) {
  const std::vector<std::string>& names = StudyArms();
  return !arm.missions.empty() && std::find(names.begin(), names.end(), arm.name) != names.end();
}

Judgement NotThere(const std::string& what) {
  Judgement judged;
  judged.why = std::string(kNotInThisRun) + what;
  return judged;
}

Judgement Counted(double ours, double paper, std::string why) {
  Judgement judged;
  judged.ours = ours, judged.paper = paper;
  judged.verdict = ours == paper ? Verdict::kReproduced : Verdict::kDiffers;
  judged.why = std::move(why);
  return judged;
}

constexpr const char* kOtherLength = "another number of missions than in the paper, on purpose";

// How long a run is, its owner chose: a shorter or longer one than the paper's speaks neither for nor against it.
Judgement Length(const metrics::ArmData& arm, double paper, std::string why) {
  Judgement judged = Counted(static_cast<double>(arm.missions.size()), paper, std::move(why));
  if (judged.verdict == Verdict::kReproduced) return judged;
  judged.verdict = Verdict::kNotMeasured;
  const bool complete = arm.failed == 0 && arm.missing == 0;
  judged.why = complete ? kOtherLength : "missions are missing or failed";
  return judged;
}

// The fewest of the arms that are claimed.
Judgement MissionsOnline(const paper::Claim& claim, std::span<const metrics::ArmData> arms, double paper) {
  const metrics::ArmData* fewest = nullptr;
  for (const metrics::ArmData& arm : arms) {
    if (!IsOnline(arm)) continue;
    if (claim.strategy != "all" && claim.strategy.find(arm.name) == std::string::npos) continue;
    if (fewest == nullptr || arm.missions.size() < fewest->missions.size()) fewest = &arm;
  }
  if (fewest == nullptr) return NotThere("the online arms");
  return Length(*fewest, paper, "missions that every arm has flown");
}

// 115K: printed to the thousand.
Judgement Samples(const metrics::ArmData& warmup, double paper) {
  const metrics::MetricValue timesteps = metrics::ComputeMetrics(warmup)["timesteps_mean"];
  const auto missions = static_cast<double>(warmup.missions.size());
  Judgement judged;
  judged.paper = paper;
  judged.ours = missions * timesteps.value, judged.lo = missions * timesteps.lo,
  judged.hi = missions * timesteps.hi;
  constexpr double kHalfThousand = 500;
  const bool inside = judged.lo - kHalfThousand <= paper && paper <= judged.hi + kHalfThousand;
  judged.verdict = inside ? Verdict::kReproduced : Verdict::kDiffers;
  judged.why = fmt::format("{:.1f} timesteps in each of {:.0f} warm-up missions", timesteps.value, missions);
  if (missions != paper::kPaperWarmupMissions)
    judged.verdict = Verdict::kNotMeasured, judged.why = kOtherLength;
  return judged;
}

Judgement SitesUsed(const metrics::ArmData& warmup, std::span<const metrics::ArmData> arms, double paper) {
  std::set<std::int64_t> sites, stations, online_sites, online_stations;
  for (const mission::MissionRecord& mission : warmup.missions)
    sites.insert(mission.site), stations.insert(mission.base_station);
  for (const metrics::ArmData& arm : arms) {
    if (!IsOnline(arm)) continue;
    for (const mission::MissionRecord& mission : arm.missions)
      online_sites.insert(mission.site), online_stations.insert(mission.base_station);
  }
  if (online_sites.empty()) return NotThere("the online arms");
  Judgement judged =
      Counted(static_cast<double>(sites.size()), paper,
              fmt::format("warm-up at {} sites and {} base station(s), online at {} and {}", sites.size(),
                          stations.size(), online_sites.size(), online_stations.size()));
  constexpr std::size_t kSites = 14,
                        kStations = 2;  // the paper's, "6 out of the 14 ... a single BS location"
  if (online_sites.size() != kSites || online_stations.size() != kStations || stations.size() != 1)
    judged.verdict = Verdict::kDiffers;
  return judged;
}

}  // namespace

Judgement JudgeSetup(const paper::Claim& claim, std::span<const metrics::ArmData> arms) {
  const auto paper = paper::PaperValueOf(claim);
  ED3R_CHECK(paper.has_value(), claim.id);
  if (claim.metric == "missions_online") return MissionsOnline(claim, arms, paper->value);
  if (claim.metric == "input_features") {
    const rfnn::NetworkDesign& design = claim.strategy == "rc-rfnn" ? rfnn::kRcNetwork : rfnn::kRobotNetwork;
    return Counted(design.inputs(), paper->value, "inputs of the network that the engine trains");
  }
  const metrics::ArmData* warmup = FindWarmup(arms);
  if (warmup == nullptr) return NotThere("the warm-up");
  if (claim.metric == "missions_warmup") return Length(*warmup, paper->value, "warm-up missions flown");
  if (claim.metric == "samples") return Samples(*warmup, paper->value);
  ED3R_CHECK(claim.metric == "sites_used", claim.id);
  return SitesUsed(*warmup, arms, paper->value);
}

}  // namespace ed3r::claims
