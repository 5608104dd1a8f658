// The files that a run's missions read, out of its store and where they can be opened: a run directory needs nothing
// beside itself.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "engine/core/files/temporary_file.h"

namespace ed3r::store {

class ResultReader;

// Lays them into a new folder among the temporary files, which goes away with it.
// Threads: const calls from any thread.
class RestoredFiles {
 public:
  // UserError where the folder cannot be written.
  explicit RestoredFiles(ResultReader& reader);

  // The file that the plan calls so. Where the store does not keep it (a run of format 1, or one with a file that was too
  // large), the one beside the sweep file of the last session, if that is still there; else UserError that names the file
  // that is missing.
  std::string PathOf(const std::string& called) const;

 private:
  std::string dir_;
  std::optional<TemporaryFolder> folder_;  // none when nothing is restored
  std::map<std::string, std::string> places_;
  std::string too_large_;   // the first file that is not kept, "" when all are
  std::string sweep_file_;  // "" where no session tells
};

}  // namespace ed3r::store
