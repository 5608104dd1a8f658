#include "studies/report/page_data.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "engine/core/check.h"
#include "engine/store/checksums.h"
#include "engine/sweep/arm_id.h"
#include "studies/claims/construction.h"
#include "studies/claims/verdict_tables.h"
#include "studies/paper/claims.h"
#include "studies/report/page_answer.h"
#include "studies/report/page_arms.h"
#include "studies/report/page_parts.h"
#include "studies/report/page_slices.h"
#include "studies/tables/data_files.h"
#include "studies/tables/paper_cell.h"

namespace ed3r::report {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kFormat = 1;
constexpr int kClaimWords = 70;

Json Number(double value) { return std::isnan(value) ? Json(nullptr) : Json(value); }

Json MetricsJson() {
  Json list = Json::array();
  for (const metrics::MetricDefinition& metric : metrics::MetricDefinitions())
    list.push_back({{"name", metric.name},
                    {"heading", tables::MetricHeading(metrics::MetricIndex(metric.name))},
                    {"label", metric.label},
                    {"group", metrics::GroupTitle(metric.group)},
                    {"unit", metric.unit},
                    {"decimals", metric.decimals}});
  return list;
}

Json PaperJson(const metrics::ArmMetrics& arm, std::size_t metric) {
  const tables::PaperCell cell = tables::MakePaperCell(paper::PaperClaims(), arm, metric);
  if (!cell.value) return nullptr;
  return {{"value", cell.value->value},
          {"text", (cell.value->approximate ? "~" : "") + cell.value->printed},
          {"within", cell.within},
          {"derived", cell.value->derived},
          {"elsewhere", cell.value->elsewhere}};
}

Json ArmJson(const PageDataInputs& inputs, std::size_t a) {
  const Json& drawn = inputs.figures.at("arms").at(a);
  const metrics::ArmMetrics& metrics = inputs.report.told[a];
  Json json = Json::object();
  for (const char* key : {"key", "stage", "name", "label", "warmup", "strategy", "eta_min_pct", "missions",
                          "failed", "missing", "networks", "convergence", "world"})
    json[key] = drawn.at(key);
  const Json& strategy = json["strategy"];
  json["about"] = strategy.is_string() ? std::string(AboutStrategy(strategy.get<std::string>())) : "";
  json["stored_name"] = metrics.stage + '/' + sweep::ArmId{metrics.name, inputs.missions.variant}.Text();
  json["paper"] = Json::object();
  for (std::size_t m = 0; m < metrics.values.size(); ++m)
    if (Json paper = PaperJson(metrics, m); !paper.is_null())
      json["paper"][std::string(metrics::MetricDefinitions()[m].name)] = std::move(paper);
  return json;
}

Json ClaimJson(const claims::JudgedClaim& judged) {
  const paper::Claim& claim = judged.claim;
  const claims::Judgement& all = judged.all;
  Json json = {{"id", claim.id},
               {"where", claim.where},
               {"arms", claim.strategy},
               {"metric", claim.metric},
               {"kind", claim.kind},
               {"claim", claims::ClaimInWords(claim, kClaimWords)},
               {"words", claim.exact_words},
               {"paper", Number(all.paper)},
               {"ours", Number(all.ours)},
               {"lo", Number(all.lo)},
               {"hi", Number(all.hi)},
               {"p", Number(all.p_holm)},
               {"p_against", Number(all.p_against_holm)},
               {"verdict", NameOf(all.verdict)},
               {"told", claims::NameWithLuck(judged)},
               {"repeats", judged.repeats},
               {"why", all.why}};
  if (claims::HoldsByConstruction(judged)) json["built"] = true;
  if (claims::PointsTheOtherWay(judged)) json["other_way"] = true;
  if (claims::ComparesP85(judged)) json["p85"] = true;
  if (const auto [same, measured] = claims::AgreeingNetworks(judged); measured > 0)
    json["networks"] = {same, measured};
  return json;
}

Json ClaimsJson(const claims::ClaimStudy& study) {
  Json json = {{"scenarios", study.scenarios},
               {"networks", study.networks},
               {"counts", Json::array()},
               {"list", Json::array()}};
  if (!study.HasArms()) return json;
  for (const auto& [verdict, count] : claims::CountVerdicts(study))
    json["counts"].push_back({NameOf(verdict), count, claims::Holds(verdict)});
  for (const claims::JudgedClaim& judged : study.claims) json["list"].push_back(ClaimJson(judged));
  json["distinct"] = claims::CountDistinct(study);
  json["by_construction"] = claims::CountReproducedByConstruction(study);
  json["rules"] = claims::VerdictRules();
  json["correction"] = claims::CorrectionNote(study);
  json["luck"] = claims::LuckNote();
  json["p85_note"] = claims::P85ClaimNote(study);
  return json;
}

Json TableJson(const tables::StudyTable& table) {
  Json json = {{"id", table.id},
               {"title", table.title},
               {"note", table.note},
               {"arms_down", table.arms_down},
               {"labels", table.labels},
               {"arms", Json::array()},
               {"missions", Json::array()},
               {"metrics", table.metrics},
               {"cells", Json::array()}};
  for (const metrics::ArmMetrics& arm : table.arms) {
    json["arms"].push_back(arm.name);
    json["missions"].push_back(arm.missions);
    Json row = Json::array();
    for (const std::size_t m : table.metrics) {
      const metrics::MetricValue& value = arm.values[m];
      row.push_back({Number(value.value), Number(value.lo), Number(value.hi), PaperJson(arm, m)});
    }
    json["cells"].push_back(std::move(row));
  }
  return json;
}

// Sites that the warm-up of any arm had seen.
Json KnownSites(std::span<const metrics::ArmData> arms) {
  std::set<std::int64_t> known;
  for (const metrics::ArmData& arm : arms)
    for (const mission::MissionRecord& mission : arm.missions)
      if (mission.site_known != 0) known.insert(mission.site);
  return known;
}

Json RunJson(const PageDataInputs& inputs) {
  const Provenance& p = inputs.provenance;
  Json json = ManifestJson(p);
  json["dir"] = p.dir;
  json["planned"] = p.planned;
  json["mixed_code"] = p.mixed_code;
  json["unchecked"] = p.unchecked ? store::kNothingToCompare : "";
  json["report_command"] = inputs.report_command;
  json["figures_note"] = inputs.figures_note;
  if (!p.sessions.empty()) {
    json["begun"] = p.sessions.front().begun_utc;
    json["ended"] = p.sessions.back().ended_utc;
    json["sessions"] = p.sessions.size();
  }
  return json;
}

const metrics::ArmData* Find(std::span<const metrics::ArmData> arms, const metrics::ArmMetrics& wanted) {
  for (const metrics::ArmData& arm : arms)
    if (arm.stage == wanted.stage && arm.name == wanted.name) return &arm;
  return nullptr;
}

}  // namespace

PageMissions PageMissionsOf(const Report& report, const RunResults& results) {
  PageMissions page;
  page.variant = report.variant;
  const std::vector<metrics::ArmData> arms = variants::ArmsOfVariant(results.arms, page.variant);
  for (const metrics::ArmMetrics& told : report.told) {
    const metrics::ArmData* arm = Find(arms, told);
    ED3R_CHECK(arm != nullptr, "the missions of an arm that is told");
    ED3R_CHECK(arm->numbers.size() == arm->missions.size(), "missions of a store");
    page.arms.push_back(*arm);
    page.numbers.push_back(arm->numbers);
  }
  return page;
}

Json MakePageData(const PageDataInputs& inputs) {
  const Report& report = inputs.report;
  std::vector<bool> warmups;
  for (const Json& arm : inputs.figures.at("arms")) warmups.push_back(arm.at("warmup").get<bool>());
  Json data = {
      {"format", kFormat},           {"name", report.name},
      {"question", inputs.question}, {"answer", AnswerSentences(report, warmups, inputs.missions.arms)},
      {"metrics", MetricsJson()},    {"arms", Json::array()}};
  data["departures"] = report.DepartureNotes();
  for (std::size_t a = 0; a < report.told.size(); ++a) data["arms"].push_back(ArmJson(inputs, a));
  const metrics::ArmMetrics* studied = StudiedArm(report, warmups);
  data["studied"] = studied == nullptr ? Json(nullptr) : Json(studied - report.told.data());
  data["slices"] = SlicesJson(inputs.missions.arms, report.told);
  data["histograms"] = HistogramsJson(inputs.missions.arms);
  data["points"] = PointsJson(inputs.missions.arms, inputs.missions.numbers);
  data["failures"] = FailuresJson(inputs.missions.arms, inputs.missions.numbers);
  data["known_sites"] = KnownSites(inputs.missions.arms);
  data["broken"] = inputs.broken;
  data["claims"] = ClaimsJson(report.claims);
  data["differences"] = variants::ArmDifferenceJson(report.differences);
  data["difference_notes"] = report.difference_notes;
  data["variant_notes"] = report.variant_notes;
  data["tables"] = Json::array();
  for (const tables::StudyTable& table : report.tables) data["tables"].push_back(TableJson(table));
  for (const char* part : {"world", "world_note", "missions_shown", "variants", "figures"})
    data[part] = inputs.figures.at(part);
  data["run"] = RunJson(inputs);
  data["viewers"] = inputs.viewers;
  data["viewers_note"] = inputs.viewers_note;
  return data;
}

}  // namespace ed3r::report
