// The tables of DIR/results.sqlite, and how a file is recognised.
//
//   recipe          key, value: sweep, seed, plan, origins (seals.h), a checksum over all tables down to runs, and
//                   two over networks and flown_networks
//   code            subsystem, identity: see recipe.h
//   inputs          name, fingerprint (of worlds and of detectors)
//   files, places   the content of every file that missions read, where it is small enough; what the plan calls it
//   stages, runs    the layout; a run is one arm of one stage
//   networks        every network that flew, as a model file with its checksum, by the hash of what it computes
//   flown_networks  which of them an arm asks, by training seed and agent
//   missions        run, mission, checksum, steps_checksum and seal (checksums.h), every column of MissionRecord
//   timesteps       run, mission, every column of TimestepRecord (k first)
//   failures        missions that threw, with scenario, seed, kind and message; flown again by the next session
//   sessions        who wrote, when and with what (session_notes): in no digest
//   timings         wall time of each mission and its session: in no digest
//
//   named_missions, named_timesteps   views of them for people: stage and arm by name, outcome, motion_rule and execution
//                   as words; units are in the columns' names. Files of before have none.
//
// missions and timesteps are clustered by their keys (WITHOUT ROWID), so that every reader gets the canonical
// order without sorting, whatever the order of arrival. A small index of the missions lets counting leave the records alone;
// files of before have none.
//
// Formats: 1 had no checksums, code, files and networks; its recipe had one code_version and its inputs were called
// worlds. It is read, but neither continued nor merged, and its readers say that nothing of it can be compared. Within a format, columns may be added to missions and timesteps: a file that
// lacks one is read with the field's initial value in its place. failures got its kind and missions their seal within
// format 2, too.
#pragma once

#include <string>
#include <vector>

#include "engine/store/layout.h"
#include "engine/store/recipe.h"
#include "engine/store/sqlite.h"

namespace ed3r::store {

inline constexpr char kResultsFile[] = "results.sqlite";
inline constexpr char kMissionsIndex[] = "missions_by_run";
// Walks the missions themselves, as SQLite calls the tree of their key. NOT INDEXED does not: with ORDER BY it takes the small
// index, which may be damaged.
inline constexpr char kAlongTheKey[] = "INDEXED BY sqlite_autoindex_missions_1";
// Raise it when a table other than missions and timesteps changes; their columns are compared by name.
inline constexpr int kSchemaVersion = 2;

enum class FileKind { kEmpty, kStore };

enum class FileUse { kRead, kWrite };

// kEmpty: a database without any table, as a run leaves it that was killed at its very start. UserError when
// the file is something else, damaged, or written by a version of the engine that this one cannot read (or, for
// kWrite, not continue).
FileKind CheckFile(Connection& database, FileUse use);

// Creates the tables and writes the recipe. Call it in a transaction.
void CreateTables(Connection& database, const Recipe& recipe, const RunLayout& layout);

// Writes another recipe and layout in place of those that the file has; the code of both counts. What is stored must fit
// it (growth.h). Call it in a transaction.
void ReplaceRecipe(Connection& database, const Recipe& recipe, const RunLayout& layout);

// Changes nothing, but has the journal of this transaction hold the file's first page, and with it whose journal it is
// (journals.h). Call it at the begin of each transaction that writes.
void WriteFirstPage(Connection& database);

// Adds the column that a file of format 2 may lack. Call it in a transaction.
void AddFailureKind(Connection& database);

// Where a file of before lacks it.
void CreateMissionsIndex(Connection& database);

// Of a session that goes on with the same plan, perhaps by other code: adds what the file does not know of it.
void ContinueRecipe(Connection& database, const Recipe& recipe);

// Writes the checksum over flown_networks, or over networks, after a change of them. Files of before have none until then. Call
// it in a transaction.
void SealUses(Connection& database);
void SealNetworkFiles(Connection& database);

// Whether the networks have the names, hashes and checksums that they were put with.
bool NetworkFilesMatch(Connection& database);

Recipe ReadRecipe(Connection& database);  // without notes and files: notes belong to sessions
std::vector<InputFile> ReadFiles(Connection& database);
RunLayout ReadLayout(Connection& database);
// Finished missions in plan order. UserError for one that is not in the plan.
std::vector<sweep::RunId> ReadStored(Connection& database, const RunLayout& layout);

}  // namespace ed3r::store
