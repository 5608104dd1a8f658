#include "engine/store/difference.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "engine/store/columns.h"
#include "engine/store/reader.h"

namespace ed3r::store {
namespace {

template <class Record>
std::vector<std::string> TextsOf(const Record& record) {
  std::vector<std::string> texts;
  Record::Describe(record,
                   [&](std::string_view, const auto& field) { texts.push_back(fmt::format("{}", field)); });
  return texts;
}

// Compares column by column; fills quantity and both texts of `found` with the first that differs.
template <class Record>
bool ColumnsDiffer(const Record& here, const Record& there, FirstDifference& found) {
  std::string a, b;
  AppendColumns(a, here);
  AppendColumns(b, there);
  if (a == b) return false;
  const std::size_t at =
      static_cast<std::size_t>(std::mismatch(a.begin(), a.end(), b.begin()).first - a.begin()) /
      sizeof(std::int64_t);
  found.quantity = ColumnsOf<Record>()[at].name;
  found.here = TextsOf(here)[at];
  found.there = TextsOf(there)[at];
  return true;
}

// Where one of the two has no timesteps stored.
std::optional<FirstDifference> CompareByChecksum(const std::string& mission, const StoredMission& here,
                                                 const StoredMission& there) {
  FirstDifference found{.mission = mission, .timestep = 0, .quantity = "", .here = "", .there = ""};
  if (ColumnsDiffer(here.record, there.record, found)) return found;
  if (here.steps_checksum == there.steps_checksum) return std::nullopt;
  found.quantity = "checksum of its timesteps";
  found.here = here.steps_checksum;
  found.there = there.steps_checksum;
  return found;
}

// The timesteps come first: they are where a difference begins.
std::optional<FirstDifference> Compare(const std::string& mission, const StoredMission& stored_here,
                                       const StoredMission& stored_there) {
  if (!stored_here.keeps_timesteps || !stored_there.keeps_timesteps)
    return CompareByChecksum(mission, stored_here, stored_there);
  const mission::MissionRecord &here = stored_here.record, &there = stored_there.record;
  FirstDifference found{.mission = mission, .timestep = 0, .quantity = "", .here = "", .there = ""};
  const std::size_t both = std::min(here.steps.size(), there.steps.size());
  for (std::size_t i = 0; i < both; ++i) {
    found.timestep = static_cast<int>(here.steps[i].k);
    if (ColumnsDiffer(here.steps[i], there.steps[i], found)) return found;
  }
  if (here.steps.size() != there.steps.size()) {
    const bool longer = here.steps.size() > both;
    found.timestep = static_cast<int>((longer ? here : there).steps[both].k);
    found.quantity = "timestep";
    (longer ? found.here : found.there) = "flown";
    return found;
  }
  found.timestep = 0;
  if (ColumnsDiffer(here, there, found)) return found;
  return std::nullopt;
}

using MissionsByNumber = std::map<int, StoredMission>;

// The place of an arm in another layout; none where it is not there.
std::optional<std::pair<int, int>> FindArm(const RunLayout& layout, const std::string& stage,
                                           const std::string& arm) {
  for (std::size_t s = 0; s < layout.stages.size(); ++s)
    for (std::size_t a = 0; a < layout.stages[s].arms.size(); ++a)
      if (layout.stages[s].name == stage && layout.stages[s].arms[a].name == arm)
        return std::pair{static_cast<int>(s), static_cast<int>(a)};
  return std::nullopt;
}

void NoteLonely(const std::string& mission, bool here, RunDifference& difference) {
  ++(here ? difference.only_here : difference.only_there);
  if (difference.first) return;
  difference.first = FirstDifference{mission, 0, "mission", "", ""};
  (here ? difference.first->here : difference.first->there) = "flown";
}

void DiffArm(ResultReader& here, ResultReader& there, std::pair<int, int> at_here,
             std::pair<int, int> at_there, RunDifference& difference) {
  // One arm is held at a time; its missions come in the order of their numbers from both.
  MissionsByNumber others;
  there.ForEachMission(at_there.first, at_there.second, Steps::kLoad,
                       [&](const StoredMission& mission) { others[mission.id.mission] = mission; });
  const auto name = [&](int mission) {
    const RunLayout::Stage& stage = here.Layout().stages[static_cast<std::size_t>(at_here.first)];
    return fmt::format("stage {}, arm {}, mission {}", stage.name,
                       stage.arms[static_cast<std::size_t>(at_here.second)].name, mission);
  };
  auto other = others.begin();
  here.ForEachMission(at_here.first, at_here.second, Steps::kLoad, [&](const StoredMission& mission) {
    const int number = mission.id.mission;
    for (; other != others.end() && other->first < number; ++other)
      NoteLonely(name(other->first), false, difference);
    if (other == others.end() || other->first != number) return NoteLonely(name(number), true, difference);
    ++difference.compared;
    if (std::optional<FirstDifference> found = Compare(name(number), mission, other->second)) {
      ++difference.differing;
      if (!difference.first) difference.first = std::move(found);
    }
    ++other;
  });
  for (; other != others.end(); ++other) NoteLonely(name(other->first), false, difference);
}

// Missions of arms that the other run's plan has not.
void NoteLonelyArms(ResultReader& run, const RunLayout& other, bool here, RunDifference& difference) {
  for (const sweep::RunId& id : run.Stored()) {
    const RunLayout::Stage& stage = run.Layout().stages[static_cast<std::size_t>(id.stage)];
    if (!FindArm(other, stage.name, stage.arms[static_cast<std::size_t>(id.arm)].name))
      NoteLonely(run.Layout().Describe(id), here, difference);
  }
}

}  // namespace

RunDifference DiffRuns(ResultReader& here, ResultReader& there) {
  RunDifference difference;
  const std::vector<RunLayout::Stage>& stages = here.Layout().stages;
  for (std::size_t s = 0; s < stages.size(); ++s)
    for (std::size_t a = 0; a < stages[s].arms.size(); ++a)
      if (const auto other = FindArm(there.Layout(), stages[s].name, stages[s].arms[a].name))
        DiffArm(here, there, {static_cast<int>(s), static_cast<int>(a)}, *other, difference);
  // Last, so that a number that differs is told before them.
  NoteLonelyArms(here, there.Layout(), true, difference);
  NoteLonelyArms(there, here.Layout(), false, difference);
  return difference;
}

}  // namespace ed3r::store
