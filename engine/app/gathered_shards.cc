#include "engine/app/gathered_shards.h"

#include <fmt/format.h>
#include <stdlib.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
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

bool HoldsResults(const std::string& dir) {
  std::error_code error;
  const std::uintmax_t bytes = fs::file_size(fs::path(dir) / store::kResultsFile, error);
  return !error && bytes > 0;
}

std::vector<sweep::RunId> Failed(store::ResultReader& reader) {
  std::vector<sweep::RunId> failed;
  for (const store::FailedMission& failure : reader.Failures()) failed.push_back(failure.id);
  return failed;
}

bool Includes(const std::vector<sweep::RunId>& all, const std::vector<sweep::RunId>& some) {
  return std::includes(all.begin(), all.end(), some.begin(), some.end());
}

// What the merged run knows of missions: a failure tells it nothing of one that it has stored.
class Merged {
 public:
  explicit Merged(const std::string& run_dir) : reader_(run_dir), stored_(reader_.Stored()) {
    const std::vector<sweep::RunId> failed = Failed(reader_);
    std::set_union(stored_.begin(), stored_.end(), failed.begin(), failed.end(), std::back_inserter(known_));
  }

  // Then shards have nothing to add, be they of the plan as it was before it grew.
  bool IsComplete() const { return std::ssize(stored_) == reader_.Layout().Missions(); }

  bool Lacks(const std::string& shard) const {
    store::ResultReader reader(shard);
    if (!reader.Layout().SameMissions(reader_.Layout())) return true;  // merging tells what is wrong with it
    return !Includes(stored_, reader.Stored()) || !Includes(known_, Failed(reader));
  }

 private:
  store::ResultReader reader_;
  std::vector<sweep::RunId> stored_, known_;
};

}  // namespace

std::vector<std::string> StoresThatAdd(const std::string& run_dir) {
  std::vector<std::string> shards = store::ShardDirs(run_dir);
  if (!HoldsResults(run_dir)) return shards;
  if (!shards.empty()) {
    const Merged merged(run_dir);
    std::erase_if(shards,
                  [&](const std::string& shard) { return merged.IsComplete() || !merged.Lacks(shard); });
  }
  shards.insert(shards.begin(), run_dir);
  return shards;
}

GatheredShards::GatheredShards(const std::string& run_dir) : dir_(run_dir) {
  const std::vector<std::string> stores = StoresThatAdd(run_dir);
  if (stores.empty() || (stores.size() == 1 && stores.front() == run_dir)) return;
  temporary_ = NewTemporaryFolder();
  dir_ = (fs::path(temporary_) / "run").string();
  try {
    store::MergeStores(dir_, stores);
  } catch (...) {
    std::error_code error;
    fs::remove_all(temporary_, error);
    throw;
  }
}

GatheredShards::~GatheredShards() {
  std::error_code error;  // what is left in $TMPDIR is the system's to clean
  if (!temporary_.empty()) fs::remove_all(temporary_, error);
}

}  // namespace ed3r::app
