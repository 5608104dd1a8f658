#include "engine/store/checksums.h"

#include <fmt/format.h>

#include "engine/core/check.h"

namespace ed3r::store {
namespace {

std::vector<std::string> ColumnsIn(Connection& database, const std::string& table) {
  Statement info(database, fmt::format("SELECT name FROM pragma_table_info('{}') WHERE name NOT IN ('run', "
                                       "'mission', 'checksum', 'steps_checksum', 'seal') ORDER BY cid",
                                       table));
  std::vector<std::string> names;
  while (info.Step()) names.push_back(info.Text(0));
  return names;
}

std::vector<sweep::KeptTimesteps> KeptIn(Connection& database) {
  Statement plan(database, "SELECT value FROM recipe WHERE key = 'plan'");
  return plan.Step() ? sweep::ReadKeptTimesteps(plan.Text(0)) : std::vector<sweep::KeptTimesteps>();
}

}  // namespace

RecordTables::RecordTables(Connection& database)
    : checked_(database.Int("PRAGMA user_version") >= kChecksumsSince),
      kept_(KeptIn(database)),
      missions_(ColumnsIn(database, "missions")),
      timesteps_(ColumnsIn(database, "timesteps")) {
  for (const std::string& unknown : {missions_.unknown(), timesteps_.unknown()})
    if (!unknown.empty())
      throw UserError(
          fmt::format("{}: written by another version of ed3r: this one does not know its column {}",
                      database.file(), unknown));
}

sweep::KeptTimesteps RecordTables::KeptOf(int stage) const {
  const auto s = static_cast<std::size_t>(stage);
  return s < kept_.size() ? kept_[s] : sweep::KeptTimesteps::kAll;
}

bool RecordTables::KeepsTimesteps(int stage, const mission::MissionRecord& record) const {
  const sweep::KeptTimesteps kept = KeptOf(stage);
  if (kept == sweep::KeptTimesteps::kFailed)
    return record.outcome != static_cast<std::int64_t>(mission::Outcome::kSuccess);
  return kept == sweep::KeptTimesteps::kAll;
}

std::string RecordTables::StepsChecksum(const std::vector<mission::TimestepRecord>& steps) const {
  std::string bytes;
  AppendText(bytes, timesteps_.names());
  AppendInt(bytes, static_cast<std::int64_t>(steps.size()));
  for (const mission::TimestepRecord& step : steps) timesteps_.Append(bytes, step);
  return HashOf(bytes);
}

std::string RecordTables::MissionChecksum(const RunLayout& layout, const sweep::RunId& id,
                                          const mission::MissionRecord& record,
                                          const std::string& steps) const {
  const RunLayout::Stage& stage = layout.stages.at(static_cast<std::size_t>(id.stage));
  std::string bytes;
  AppendText(bytes, stage.name);
  AppendText(bytes, stage.arms.at(static_cast<std::size_t>(id.arm)).name);
  AppendInt(bytes, id.mission);
  AppendText(bytes, missions_.names());
  missions_.Append(bytes, record);
  AppendText(bytes, steps);
  return HashOf(bytes);
}

Checksums RecordTables::Of(const RunLayout& layout, const sweep::RunId& id,
                           const mission::MissionRecord& record) const {
  const std::string steps = StepsChecksum(record.steps);
  return {MissionChecksum(layout, id, record, steps), steps};
}

}  // namespace ed3r::store
