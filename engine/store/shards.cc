#include "engine/store/shards.h"

#include <algorithm>
#include <filesystem>

#include "engine/store/schema.h"

namespace ed3r::store {
namespace {

namespace fs = std::filesystem;

void AddTasks(const fs::path& stage, std::vector<std::string>& dirs) {
  std::error_code error;  // a folder that is gone by now holds nothing
  for (const fs::directory_entry& task : fs::directory_iterator(stage, error)) {
    const std::uintmax_t bytes = fs::file_size(task.path() / kResultsFile, error);
    if (!error && bytes > 0) dirs.push_back(task.path().string());
  }
}

}  // namespace

std::vector<std::string> ShardDirs(const std::string& run_dir, const std::string& stage) {
  std::vector<std::string> dirs;
  AddTasks(fs::path(run_dir) / "shards" / stage, dirs);
  std::sort(dirs.begin(), dirs.end());
  return dirs;
}

std::vector<std::string> ShardDirs(const std::string& run_dir) {
  std::vector<std::string> dirs;
  std::error_code error;
  for (const fs::directory_entry& stage : fs::directory_iterator(fs::path(run_dir) / "shards", error))
    AddTasks(stage.path(), dirs);
  std::sort(dirs.begin(), dirs.end());
  return dirs;
}

}  // namespace ed3r::store
