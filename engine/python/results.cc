#include "engine/python/results.h"

#include <fmt/format.h>

#include <type_traits>
#include <utility>

#include "engine/core/check.h"
#include "engine/core/suggest.h"
#include "engine/store/columns.h"
#include "engine/store/digest.h"
#include "engine/store/words.h"
#include "studies/report/load.h"
#include "studies/report/report.h"

namespace ed3r::python {
namespace {

template <class Record>
std::vector<ResultColumn> EmptyTable() {
  std::vector<ResultColumn> table = {{.name = "arm"}, {.name = "mission"}};
  for (const store::Column& column : store::ColumnsOf<Record>())
    table.push_back({.name = column.name, .is_real = column.is_real});
  return table;
}

template <class Record>
void AddRow(std::int64_t arm, std::int64_t mission, const Record& record, std::vector<ResultColumn>& table) {
  table[0].integers.push_back(arm);
  table[1].integers.push_back(mission);
  std::size_t next = 2;
  Record::Describe(record, [&](std::string_view, const auto& field) {
    if constexpr (std::is_same_v<std::remove_cvref_t<decltype(field)>, double>)
      table[next++].reals.push_back(field);
    else
      table[next++].integers.push_back(field);
  });
}

}  // namespace

std::vector<ArmCount> RunReader::Arms() {
  reader_.CheckNotReplaced();
  std::vector<ArmCount> arms;
  for (const store::ArmStatus& arm : reader_.Status())
    arms.push_back({arm.stage, arm.arm, arm.planned, arm.done, arm.failed});
  return arms;
}

// (stage, arm) of what was asked for; RunId::mission is the arm's place in Arms().
std::vector<sweep::RunId> RunReader::Selected(const std::string& arm) const {
  std::vector<sweep::RunId> selected;
  std::vector<std::string> names;
  const store::RunLayout& layout = reader_.Layout();
  int place = 0;
  for (std::size_t s = 0; s < layout.stages.size(); ++s)
    for (std::size_t a = 0; a < layout.stages[s].arms.size(); ++a) {
      const std::string& name = layout.stages[s].arms[a].name;
      names.push_back(name);
      if (arm.empty() || arm == name || arm == layout.stages[s].name + "/" + name)
        selected.push_back({static_cast<int>(s), static_cast<int>(a), place});
      ++place;
    }
  if (selected.empty()) {
    const std::string nearest = NearestWord(arm, names);
    throw UserError(fmt::format("{}: no arm '{}'; the arms are {}{}", dir_, arm, fmt::join(names, ", "),
                                nearest.empty() ? "" : fmt::format("; did you mean {}?", nearest)));
  }
  if (!arm.empty()) CheckOneStage(arm, selected);
  return selected;
}

void RunReader::CheckOneStage(const std::string& arm, std::vector<sweep::RunId>& selected) const {
  const auto& stages = reader_.Layout().stages;
  const auto stage_of = [&](const sweep::RunId& id) -> const store::RunLayout::Stage& {
    return stages[static_cast<std::size_t>(id.stage)];
  };
  if (selected.size() > 1)  // what was trained is no arm that flew
    std::erase_if(selected, [&](const sweep::RunId& id) { return stage_of(id).missions == 0; });
  if (selected.size() < 2) return;
  std::vector<std::string> names;
  for (const sweep::RunId& id : selected) names.push_back(stage_of(id).name + "/" + arm);
  throw UserError(fmt::format("{}: arm '{}' is of several stages; give STAGE/ARM: {}", dir_, arm,
                              fmt::join(names, ", ")));
}

std::vector<ResultColumn> RunReader::Missions(const std::string& arm) {
  reader_.CheckNotReplaced();
  std::vector<ResultColumn> table = EmptyTable<mission::MissionRecord>();
  for (const sweep::RunId& id : Selected(arm))
    reader_.ForEachMission(id.stage, id.arm, store::Steps::kSkip, [&](const store::StoredMission& mission) {
      AddRow(id.mission, mission.id.mission, mission.record, table);
    });
  return table;
}

std::vector<ResultColumn> RunReader::Timesteps(const std::string& arm) {
  reader_.CheckNotReplaced();
  std::vector<ResultColumn> table = EmptyTable<mission::TimestepRecord>();
  for (const sweep::RunId& id : Selected(arm))
    reader_.ForEachTimestep(id.stage, id.arm, [&](int mission, const mission::TimestepRecord& step) {
      AddRow(id.mission, mission, step, table);
    });
  return table;
}

std::string RunReader::ReportText() {
  reader_.CheckNotReplaced();
  const store::Transaction moment = reader_.Moment();
  return report::ReportJson(report::MakeReport(report::LoadRun(reader_), report::ReadDepartures(reader_)))
      .dump();
}

std::string RunReader::Digest() {
  reader_.CheckNotReplaced();
  return store::DigestOf(reader_);
}

std::map<std::string, std::map<std::int64_t, std::string>> CodeNames() {
  std::map<std::string, std::map<std::int64_t, std::string>> names;
  for (const std::string column : {"outcome", "execution", "motion_rule"})
    for (const auto& [code, word] : store::WordsOf(column)) names[column][code] = std::string(word);
  return names;
}

}  // namespace ed3r::python
