// A run that was found whole and complete, remembered in its own file, so that the same command again need not read all of it.
//
// It is believed only by the program that wrote it and while the file is untouched: SQLite's change counter and the time of
// the last write must be what they were, nothing may have changed the file or its times since, and what was printed must match
// its checksum. Damage of missions below the file system is found by whatever compares them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace ed3r::store {

struct FinishedRun {
  std::string made_by;  // names the program
  std::int64_t missions = 0;
  std::string table;     // what the command printed: the results; "" where it was quiet
  std::string networks;  // and the networks
};

// Which state of which file something was told from. -1 throughout where it cannot be seen.
struct FileMoment {
  std::int64_t device = -1, inode = -1, bytes = -1, changes = -1;
  bool operator==(const FileMoment&) const = default;
};
FileMoment LookAtFile(const std::string& dir);

// Does nothing where the file has left the state that was told from, is of another plan or holds other missions than the plan
// and the run say, where another process is at it, or several machines may be.
void RememberFinished(const std::string& dir, const FileMoment& told, const std::string& plan_text,
                      const FinishedRun& run);

// Nothing where the file was touched, made by another program, or never remembered.
std::optional<FinishedRun> RecallFinished(const std::string& dir, const std::string& made_by);

}  // namespace ed3r::store
