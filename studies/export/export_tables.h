// Results as tables for other tools: missions and timesteps of a run with stage, arm and codes by name, and units in the
// names of the columns.
//
// Columns: stage, arm, mission (its number in its arm), then those of MissionRecord or TimestepRecord (record.h) in their
// order. outcome, motion_rule and execution stand as words ("success", "hover", "offload"). Where no network was asked a
// predicted reward is empty in CSV and NaN in numpy.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "engine/core/files/file.h"
#include "engine/store/reader.h"

namespace ed3r::exports {

enum class ExportFormat { kCsv, kNumpy };

struct ExportedTable {
  std::filesystem::path file;
  std::int64_t rows = 0;
};

// Writes missions and timesteps for `folder`, which is there, as two files of `files`, which the caller commits.
//   kCsv    missions.csv, timesteps.csv: RFC 4180, numbers in the shortest text that reads back to the same bits
//   kNumpy  missions.npy, timesteps.npy: one structured array each; words are '<U' texts
// Every mission is compared with its checksum. Throws UserError.
std::vector<ExportedTable> ExportTables(store::ResultReader& reader, ExportFormat format,
                                        const std::filesystem::path& folder, FileSet& files);

// A line for each stage whose sweep keeps the timesteps of some missions alone: what is computed from its timesteps is not of
// the stage.
std::vector<std::string> TimestepNotes(store::ResultReader& reader);

}  // namespace ed3r::exports
