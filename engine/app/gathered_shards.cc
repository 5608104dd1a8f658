#include "engine/app/gathered_shards.h"

#include <fmt/format.h>
#include <stdlib.h>

#include <algorithm>
#include <filesystem>
#include <vector>

#include "engine/core/check.h"
#include "engine/store/merge.h"
#include "engine/store/reader.h"
#include "engine/store/schema.h"
#include "engine/store/shards.h"

namespace ed3r::app {
namespace {

namespace fs = std::filesystem;

std::string NewTemporaryFolder() {
  std::string name = (fs::temp_directory_path() / "ed3r-shards-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr)
    throw UserError(fmt::format("{}: no folder can be made here for the joined shards", name));
  return name;
}

// Whether no mission is missing in the merged run, so that the shards have nothing to add.
bool IsComplete(const std::string& run_dir) {
  const std::vector<store::ArmStatus> arms = store::ResultReader(run_dir).Status();
  return std::all_of(arms.begin(), arms.end(), [](const store::ArmStatus& arm) { return arm.missing == 0; });
}

}  // namespace

GatheredShards::GatheredShards(const std::string& run_dir) : dir_(run_dir) {
  std::vector<std::string> stores = store::ShardDirs(run_dir);
  if (stores.empty()) return;
  std::error_code error;  // none there: nothing has been merged yet
  const std::uintmax_t merged_bytes = fs::file_size(fs::path(run_dir) / store::kResultsFile, error);
  const bool merged = !error && merged_bytes > 0;
  if (merged && IsComplete(run_dir)) return;
  if (merged) stores.insert(stores.begin(), run_dir);
  temporary_ = NewTemporaryFolder();
  dir_ = (fs::path(temporary_) / "run").string();
  try {
    store::MergeStores(dir_, stores);
  } catch (...) {
    fs::remove_all(temporary_, error);
    throw;
  }
}

GatheredShards::~GatheredShards() {
  std::error_code error;  // what is left in $TMPDIR is the system's to clean
  if (!temporary_.empty()) fs::remove_all(temporary_, error);
}

}  // namespace ed3r::app
