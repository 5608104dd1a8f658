// What is wrong with the missions of a file, and how it is taken out. Within a transaction of the caller's.
#pragma once

#include <functional>
#include <vector>

#include "engine/store/layout.h"
#include "engine/store/records.h"
#include "engine/store/sqlite.h"

namespace ed3r::store {

// Every mission that does not match its checksums or is not in the plan, timesteps without a mission, failures and
// times that are not in the plan; by key. UserError where SQLite's own check finds the file's trees damaged. Reads everything. `on_whole` is called for each mission that is whole, in canonical order,
// with its timesteps loaded.
std::vector<DamagedMission> FindDamage(Connection& database, const RunLayout& layout,
                                       const std::function<void(const MissionCursor&)>& on_whole = {});

// What to do with damaged missions where the plan grows over them.
enum class Repair { kNo, kYes, kOfAPart };  // the last: asked for, by a call that does not fly all of it

// Deletes all that the file holds of these missions, so that they count as missing.
void RemoveMissions(Connection& database, const std::vector<DamagedMission>& missions);

}  // namespace ed3r::store
