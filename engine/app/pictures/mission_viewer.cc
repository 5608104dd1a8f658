#include "engine/app/pictures/mission_viewer.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "engine/app/decision_text.h"
#include "engine/app/execution_reason.h"
#include "engine/app/pictures/mission_clock.h"
#include "engine/app/pictures/viewer_distractors.h"
#include "engine/app/pictures/viewer_frames.h"
#include "engine/app/pictures/viewer_rays.h"
#include "engine/core/check.h"
#include "studies/figures/mission_columns.h"
#include "studies/tables/names.h"

namespace ed3r::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kTraceStride = 8;  // of kTraceHz: three points a second
constexpr int kMostNodes = 200;  // of the drawn ground along its longer side
constexpr std::size_t kBestCandidates = 24, kOtherCandidates = 40;

// Keeps every kTraceStride-th sample and the last one of each timestep.
class Track : public robot::TraceSink {
 public:
  explicit Track(const mission::MissionTask& task) : rays_(task.scene, task.config) {}
  void Record(const robot::TraceSample& sample) override {
    if (sample.timestep != last_.timestep && count_ > 0) Keep();
    last_ = sample;
    if (count_++ % kTraceStride == 0) Keep();
  }
  Json ToJson(const std::vector<double>& begins) {
    if (count_ > 0) Keep();
    Json json = {{"t_s", Json::array()},
                 {"x_m", Json::array()},
                 {"y_m", Json::array()},
                 {"z_m", Json::array()},
                 {"yaw_rad", Json::array()}};
    for (const robot::TraceSample& s : samples_) {
      json["t_s"].push_back(figures::Rounded(begins.at(s.timestep - 1) + s.time_s, 2));
      json["x_m"].push_back(figures::Rounded(s.position_m.x(), 2));
      json["y_m"].push_back(figures::Rounded(s.position_m.y(), 2));
      json["z_m"].push_back(figures::Rounded(s.position_m.z(), 2));
      json["yaw_rad"].push_back(figures::Rounded(s.yaw_rad, 3));
    }
    return json;
  }
  Json ShortRaysJson() const {
    Json list = Json::array();
    for (std::size_t i = 0; i < samples_.size(); ++i) rays_.Add(i, samples_[i], list);
    return list;
  }

 private:
  void Keep() {
    if (samples_.empty() || samples_.back().timestep != last_.timestep ||
        samples_.back().time_s != last_.time_s)
      samples_.push_back(last_);
  }

  ShortRays rays_;
  std::vector<robot::TraceSample> samples_;
  robot::TraceSample last_;
  std::size_t count_ = 0;
};

// One flight tells of many timesteps: once the next one flies, what was asked about the last is complete, and the one after
// the next can still be asked about.
class Asking : public robot::TraceSink {
 public:
  Asking(std::set<std::uint32_t>& open, std::map<std::uint32_t, mission::DecisionProbe>& found)
      : open_(open), found_(found) {
    probe.timestep = *open_.begin();
  }
  void Record(const robot::TraceSample& sample) override {
    if (probe.reached && sample.timestep > probe.timestep) Next(sample.timestep);
  }
  void Finish() {
    if (probe.reached) Take();
  }

  mission::DecisionProbe probe;

 private:
  void Take() {
    open_.erase(probe.timestep);
    found_.emplace(probe.timestep, probe);
    probe = {};
  }
  void Next(std::uint32_t flying) {
    Take();
    const auto next = open_.upper_bound(flying);
    if (next != open_.end()) probe.timestep = *next;
  }

  std::set<std::uint32_t>& open_;
  std::map<std::uint32_t, mission::DecisionProbe>& found_;
};

std::map<std::uint32_t, mission::DecisionProbe> AskAgents(mission::MissionTask task, std::int64_t timesteps) {
  std::set<std::uint32_t> open;
  for (std::int64_t k = 1; k <= timesteps; ++k) open.insert(static_cast<std::uint32_t>(k));
  std::map<std::uint32_t, mission::DecisionProbe> found;
  while (!open.empty()) {
    const std::size_t before = found.size();
    Asking asking(open, found);
    task.trace = &asking;
    task.probe = &asking.probe;
    mission::FlyMission(task);
    asking.Finish();
    ED3R_CHECK(found.size() > before, "a flight again meets the timesteps of the stored one");
  }
  return found;
}

Json CandidatesJson(const agents::CandidateTrace& trace) {
  std::vector<std::size_t> order(trace.rewards.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return trace.rewards[a] > trace.rewards[b]; });
  Json list = Json::array();
  const std::size_t stride = std::max<std::size_t>(1, order.size() / kOtherCandidates);
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (i >= kBestCandidates && i % stride != 0) continue;
    const std::size_t at =
        trace.admitted.empty() ? order[i] : static_cast<std::size_t>(trace.admitted[order[i]]);
    const Eigen::Vector3d& move_m = trace.commands[at].displacement_m;
    list.push_back({figures::Rounded(move_m.x(), 1), figures::Rounded(move_m.y(), 1),
                    figures::Rounded(move_m.z(), 1), figures::Rounded(trace.rewards[order[i]])});
  }
  return list;
}

Json DecisionJson(const mission::MissionTask& task, const mission::DecisionProbe& probe,
                  const mission::TimestepRecord& step) {
  Json rewards = Json::array();
  for (const double reward : probe.robot_rewards) rewards.push_back(figures::Rounded(reward));
  return {{"rule", NameOf(static_cast<agents::MotionRule>(step.motion_rule))},
          {"why", BandText(step.band)},
          {"drawn", probe.candidates.commands.size()},
          {"admitted", probe.candidates.rewards.size()},
          {"candidates", CandidatesJson(probe.candidates)},
          {"robot_rewards", rewards},
          {"execution_text", ExecutionText(task, probe)}};
}

Json StepsJson(const mission::MissionRecord& record, const std::vector<double>& begins) {
  Json columns = Json::object();
  for (std::size_t i = 0; i < record.steps.size(); ++i) {
    columns["begin_s"].push_back(figures::Rounded(begins[i]));
    columns["duration_s"].push_back(figures::Rounded(DurationS(record.steps[i])));
    mission::TimestepRecord::Describe(record.steps[i], [&](std::string_view name, const auto& value) {
      columns[std::string(name)].push_back(figures::Rounded(static_cast<double>(value)));
    });
  }
  return columns;
}

void AddDecisions(const mission::MissionTask& task, const mission::MissionRecord& record, Json& json) {
  json["decisions"] = Json::array();
  const std::map<std::uint32_t, mission::DecisionProbe> probes = AskAgents(task, record.timesteps);
  for (const mission::TimestepRecord& step : record.steps)
    json["decisions"].push_back(DecisionJson(task, probes.at(static_cast<std::uint32_t>(step.k)), step));
}

}  // namespace

Json ViewerMission(StoredRun& run, const std::string& mission) {
  const sweep::RunId id = run.Find(mission);
  const store::StoredMission stored = run.Reader().LoadMission(id);
  mission::MissionTask task = run.Task(id);
  Track track(task);
  task.trace = &track;
  const mission::MissionRecord record = mission::FlyMission(task);
  task.trace = nullptr;
  const std::vector<double> begins = BeginsS(record);
  const sweep::Stage& stage = run.Plan().stages.at(static_cast<std::size_t>(id.stage));
  const Config& config = task.config;
  Json json = {
      {"name", mission},
      {"label", tables::ArmLabel(stage.arms.at(static_cast<std::size_t>(id.arm)).name)},
      {"number", id.mission},
      {"outcome", record.outcome},
      {"outcome_name", NameOf(static_cast<mission::Outcome>(record.outcome))},
      {"identical", run.Reader().IsStored(record, stored)},
      {"site", record.site},
      {"base_station", record.base_station},
      {"scenario", record.scenario},
      {"tier", task.pixels != nullptr ? "pixels" : "profile"},
      {"eta_min", config.agents.eta_min},
      {"camera",
       {{"hfov_deg", config.sensing.camera_hfov_deg},
        {"frames", config.sensing.Frames()},
        {"aspect", static_cast<double>(config.sensing.camera_width_px) / config.sensing.camera_height_px}}},
      {"duration_s", begins.back()},
      {"energy_j", record.total_j},
      {"battery_j", record.battery_left_j + record.total_j},
      {"start", {record.start_x_m, record.start_y_m, record.start_z_m, record.start_yaw_rad}}};
  json["track"] = track.ToJson(begins);
  json["lidar"] = {{"range_m", config.sensing.lidar_range_m},
                   {"safety_m", config.robot.safety_distance_m},
                   {"met", track.ShortRaysJson()}};
  json["steps"] = StepsJson(record, begins);
  json["distractors"] = ViewerDistractors(task, record);
  json["frames"] = ViewerFrames(task, record);
  AddDecisions(task, record, json);
  return json;
}

Json ViewerWorld(const world::Scene& scene) {
  const world::Terrain& ground = scene.Ground();
  const int stride = std::max(1, (std::max(ground.columns, ground.rows) + kMostNodes - 1) / kMostNodes);
  Json json = {{"name", scene.Name()},
               {"size_m", {scene.SizeM().x(), scene.SizeM().y(), scene.SizeM().z()}},
               {"cell_m", stride * ground.cell_m},
               {"height_m", Json::array()}};
  for (int r = 0; r < ground.rows; r += stride) {
    Json row = Json::array();
    for (int c = 0; c < ground.columns; c += stride)
      row.push_back(figures::Rounded(ground.height_m[static_cast<std::size_t>(r) * ground.columns + c], 1));
    json["height_m"].push_back(std::move(row));
  }
  json["trees"] = Json::array();
  for (const world::Tree& tree : scene.Trees())
    json["trees"].push_back({figures::Rounded(tree.x_m, 1), figures::Rounded(tree.y_m, 1),
                             figures::Rounded(tree.ground_m, 1), figures::Rounded(tree.height_m, 1),
                             figures::Rounded(tree.crown_radius_m, 1)});
  const auto place = [](const std::string& name, const Eigen::Vector3d& at_m) {
    return Json{{"name", name},
                {"x_m", figures::Rounded(at_m.x(), 1)},
                {"y_m", figures::Rounded(at_m.y(), 1)},
                {"z_m", figures::Rounded(at_m.z(), 1)}};
  };
  json["sites"] = Json::array();
  for (const world::FireSite& site : scene.Sites()) json["sites"].push_back(place(site.name, site.base_m));
  json["base_stations"] = Json::array();
  for (const world::BaseStation& station : scene.BaseStations())
    json["base_stations"].push_back(place(station.name, station.antenna_m));
  const world::FireShape& fire = scene.Fire();
  json["fire"] = {{"flame_height_m", fire.flame_height_m},
                  {"flame_radius_m", fire.flame_radius_m},
                  {"total_height_m", fire.total_height_m},
                  {"smoke_top_radius_m", fire.smoke_top_radius_m},
                  {"lean_m", {fire.lean_x_m, fire.lean_y_m}}};
  return json;
}

}  // namespace ed3r::app
