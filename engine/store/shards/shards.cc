#include "engine/store/shards/shards.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "engine/core/check.h"
#include "engine/store/schema.h"

namespace ed3r::store {
namespace {

namespace fs = std::filesystem;

// What is not there, or no more, holds nothing, nor does a FIFO, which whoever opens it names; of what cannot be looked at that
// is not known.
void CheckAbsent(const fs::path& path, const std::error_code& error) {
  if (error && error != std::errc::no_such_file_or_directory && error != std::errc::not_a_directory &&
      error != std::errc::is_a_directory && error != std::errc::not_supported)
    throw UserError(fmt::format("{}: {}", path.string(), error.message()));
}

std::vector<fs::path> Entries(const fs::path& folder) {
  std::vector<fs::path> entries;
  std::error_code error;
  fs::directory_iterator entry(folder, error);
  for (; !error && entry != fs::directory_iterator(); entry.increment(error))
    entries.push_back(entry->path());
  CheckAbsent(folder, error);
  return entries;
}

void AddTasks(const fs::path& stage, std::vector<std::string>& dirs) {
  for (const fs::path& task : Entries(stage))
    if (HoldsResults(task.string())) dirs.push_back(task.string());
}

}  // namespace

bool HoldsResults(const std::string& dir) {
  const fs::path file = fs::path(dir) / kResultsFile;
  std::error_code error;
  const std::uintmax_t bytes = fs::file_size(file, error);
  CheckAbsent(file, error);
  return !error && bytes > 0;
}

std::vector<std::string> ShardDirs(const std::string& run_dir, const std::string& stage) {
  std::vector<std::string> dirs;
  AddTasks(fs::path(run_dir) / "shards" / stage, dirs);
  std::sort(dirs.begin(), dirs.end());
  return dirs;
}

std::vector<std::string> EmptyShardDirs(const std::string& run_dir) {
  std::vector<std::string> dirs;
  std::error_code error;
  for (const fs::path& stage : Entries(fs::path(run_dir) / "shards"))
    for (const fs::path& task : Entries(stage))
      if (fs::exists(task / kResultsFile, error) && !HoldsResults(task.string()))
        dirs.push_back(task.string());
  std::sort(dirs.begin(), dirs.end());
  return dirs;
}

std::vector<std::string> ShardDirs(const std::string& run_dir) {
  std::vector<std::string> dirs;
  for (const fs::path& stage : Entries(fs::path(run_dir) / "shards")) AddTasks(stage, dirs);
  std::sort(dirs.begin(), dirs.end());
  return dirs;
}

}  // namespace ed3r::store
