// The tables of DIR/results.sqlite, and how a file is recognised.
//
//   recipe         key, value: sweep, seed, plan, code_version     identity: see recipe.h
//   worlds         file, fingerprint (of world files and of detectors)
//   stages, runs   the layout; a run is one arm of one stage
//   missions       run, mission, every column of MissionRecord
//   timesteps      run, mission, every column of TimestepRecord (k first)
//   failures       missions that threw, with scenario, seed and message; flown again by the next session
//   sessions       who wrote, when and with what (session_notes): in no digest
//   timings        wall time of each mission and its session: in no digest
//
// missions and timesteps are clustered by their keys (WITHOUT ROWID), so that every reader gets the canonical
// order without sorting, whatever the order of arrival.
#pragma once

#include <string>
#include <vector>

#include "engine/store/layout.h"
#include "engine/store/recipe.h"
#include "engine/store/sqlite.h"

namespace ed3r {

inline constexpr char kResultsFile[] = "results.sqlite";
// Raise it when a table other than missions and timesteps changes; their columns are compared by name.
inline constexpr int kSchemaVersion = 1;

enum class FileKind { kEmpty, kStore };

// kEmpty: a database without any table, as a run leaves it that was killed at its very start. UserError when
// the file is something else, damaged, or written by another version of the engine.
FileKind CheckFile(Connection& database);

// Creates the tables and writes the recipe. Call it in a transaction.
void CreateTables(Connection& database, const Recipe& recipe, const RunLayout& layout);

Recipe ReadRecipe(Connection& database);  // without notes: those belong to sessions
RunLayout ReadLayout(Connection& database);
std::vector<RunId> ReadStored(Connection& database);  // finished missions in plan order

}  // namespace ed3r
