#include "studies/figures/figure_data.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "engine/core/check.h"
#include "studies/figures/mission_columns.h"
#include "studies/paper/claims.h"
#include "studies/tables/data_files.h"
#include "studies/tables/names.h"

namespace ed3r::figures {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kFormat = 1;
constexpr int kMostNodes = 220;  // of the drawn ground along its longer side

Json EtaMin(const ArmPlan* plan) {
  const std::string text = plan == nullptr ? "" : plan->Setting("agents.eta_min");
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && !text.empty() ? Rounded(100 * value) : Json(nullptr);
}

Json ArmJson(const FigureInputs& inputs, std::size_t a, const std::string& key, const Json& metrics) {
  const metrics::ArmData& arm = inputs.arms[a];
  const ArmPlan* plan = PlanOf(inputs.plans, arm);
  const std::string strategy = plan == nullptr ? "" : plan->Setting("mission.strategy");
  Json json = {
      {"key", key},
      {"stage", arm.stage},
      {"name", arm.name},
      {"label", key == arm.name ? tables::ArmLabel(arm.name) : arm.stage + '/' + tables::ArmLabel(arm.name)},
      {"warmup", plan != nullptr && plan->warmup},
      {"strategy", strategy.empty() ? Json(nullptr) : Json(strategy)},
      {"eta_min_pct", EtaMin(plan)},
      {"world", plan == nullptr ? Json(nullptr) : Json(plan->Setting("mission.world"))},
      {"missions", arm.missions.size()},
      {"failed", arm.failed},
      {"missing", arm.missing},
      {"networks", inputs.metrics[a].networks},
      {"metrics", Json::object()}};
  for (const metrics::MetricDefinition& definition : metrics::MetricDefinitions()) {
    const std::string name(definition.name);
    json["metrics"][name] = metrics.at(name);
  }
  json["per_mission"] = MissionColumns(arm);
  json["sites"] = SiteSuccess(arm);
  json["known_sites"] = PooledSuccess(arm, true);
  json["unseen_sites"] = PooledSuccess(arm, false);
  json["convergence"] = ConvergenceJson(arm, claims::Convergence(inputs.arms.subspan(a, 1)));
  return json;
}

Json FigureJson(const FigureSpec& figure, const std::vector<std::string>& keys) {
  const auto names = [&](const std::vector<std::size_t>& arms) {
    Json list = Json::array();
    for (const std::size_t a : arms) list.push_back(keys[a]);
    return list;
  };
  return {{"id", figure.id},           {"kind", figure.kind},        {"title", figure.title},
          {"caption", figure.caption}, {"arms", names(figure.arms)}, {"warmups", names(figure.warmups)}};
}

Json MissionJson(const ShownMission& mission) {
  const mission::MissionRecord& record = mission.record;
  Json json = {{"arm", mission.arm},
               {"label", tables::ArmLabel(mission.arm)},
               {"stage", mission.stage},
               {"mission", mission.number},
               {"outcome", NameOf(static_cast<mission::Outcome>(record.outcome))},
               {"site", record.site},
               {"base_station", record.base_station},
               {"duration_min", Rounded(record.duration_s / 60)},
               {"energy_kj", Rounded(record.total_j / 1000)},
               {"x_m", {Rounded(record.start_x_m, 1)}},
               {"y_m", {Rounded(record.start_y_m, 1)}},
               {"z_m", {Rounded(record.start_z_m, 1)}},
               {"scs_pct", {nullptr}}};
  for (const mission::TimestepRecord& step : record.steps) {
    json["x_m"].push_back(Rounded(step.x_m, 1));
    json["y_m"].push_back(Rounded(step.y_m, 1));
    json["z_m"].push_back(Rounded(step.z_m, 1));
    json["scs_pct"].push_back(Rounded(100 * step.scs, 1));
  }
  return json;
}

// Heights at nodes wide enough apart for a picture.
Json GroundJson(const world::Terrain& ground) {
  const int stride = std::max(1, (std::max(ground.columns, ground.rows) + kMostNodes - 1) / kMostNodes);
  Json rows = Json::array();
  for (int r = 0; r < ground.rows; r += stride) {
    Json row = Json::array();
    for (int c = 0; c < ground.columns; c += stride)
      row.push_back(Rounded(ground.height_m[static_cast<std::size_t>(r) * ground.columns + c], 1));
    rows.push_back(std::move(row));
  }
  return {{"cell_m", stride * ground.cell_m}, {"height_m", std::move(rows)}};
}

Json PlaceJson(const std::string& name, const Eigen::Vector3d& at_m, bool known) {
  return {{"name", name}, {"x_m", Rounded(at_m.x(), 1)}, {"y_m", Rounded(at_m.y(), 1)}, {"known", known}};
}

Json WorldJson(const world::Scene& scene) {
  Json json = {{"name", scene.Name()}, {"size_m", {scene.SizeM().x(), scene.SizeM().y(), scene.SizeM().z()}}};
  json.update(GroundJson(scene.Ground()));
  json["trees"] = Json::array();
  for (const world::Tree& tree : scene.Trees())
    json["trees"].push_back({Rounded(tree.x_m, 1), Rounded(tree.y_m, 1), Rounded(tree.crown_radius_m, 1)});
  json["sites"] = Json::array();
  for (const world::FireSite& site : scene.Sites())
    json["sites"].push_back(PlaceJson(site.name, site.base_m, site.known));
  json["base_stations"] = Json::array();
  for (const world::BaseStation& station : scene.BaseStations())
    json["base_stations"].push_back(PlaceJson(station.name, station.antenna_m, station.known));
  return json;
}

Json VariantsJson(const variants::VariantStudy& study) {
  Json json = {{"base", study.variants.front()},
               {"names", std::vector<std::string>(study.variants.begin() + 1, study.variants.end())},
               {"differences", Json::array()}};
  for (const variants::VariantDifference& d : study.differences)
    json["differences"].push_back({{"arm", d.arm},
                                   {"label", tables::ArmLabel(d.arm)},
                                   {"variant", d.variant},
                                   {"metric", d.metric},
                                   {"difference", Rounded(d.difference)},
                                   {"lo", Rounded(d.lo)},
                                   {"hi", Rounded(d.hi)},
                                   {"certain", d.Certain()}});
  return json;
}

}  // namespace

Json MakeFigureData(const FigureInputs& inputs) {
  ED3R_CHECK(inputs.arms.size() == inputs.metrics.size(), "metrics of every arm");
  const std::vector<std::string> keys = tables::UniqueArmNames(inputs.metrics);
  const Json metrics = tables::ResultJson(inputs.metrics, paper::PaperClaims()).at("arms");
  Json data = {{"format", kFormat}, {"name", inputs.name}, {"units", ColumnUnits()}, {"arms", Json::array()}};
  for (std::size_t a = 0; a < inputs.arms.size(); ++a)
    data["arms"].push_back(ArmJson(inputs, a, keys[a], metrics.at(keys[a])));
  data["figures"] = Json::array();
  for (const FigureSpec& figure : ListFigures(inputs.arms, inputs.plans, inputs.missions.size()))
    data["figures"].push_back(FigureJson(figure, keys));
  const bool varied = inputs.variants != nullptr && inputs.variants->variants.size() > 1;
  if (varied) data["figures"].push_back(FigureJson(VariantFigure(inputs.variants->variants.front()), keys));
  data["variants"] = varied ? VariantsJson(*inputs.variants) : Json(nullptr);
  data["missions_shown"] = Json::array();
  for (const ShownMission& mission : inputs.missions) data["missions_shown"].push_back(MissionJson(mission));
  data["world"] = inputs.scene ? WorldJson(*inputs.scene) : Json(nullptr);
  data["world_note"] = inputs.scene_note;
  return data;
}

}  // namespace ed3r::figures
