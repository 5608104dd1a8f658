#include "engine/store/shards/gathered_shards.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <utility>
#include <vector>

#include "engine/core/check.h"
#include "engine/store/part_of_run.h"
#include "engine/store/reader.h"
#include "engine/store/schema.h"
#include "engine/store/shards/merge.h"
#include "engine/store/shards/shards.h"

namespace ed3r::store {
namespace {

namespace fs = std::filesystem;

std::string Shards(std::int64_t count) { return fmt::format("{} shard{}", count, count == 1 ? "" : "s"); }

// The command that takes in a shard and those beside it, in a quote that is left open.
std::string MergeOf(const std::string& run_dir, const std::string& shard) {
  return fmt::format("'ed3r merge {} {}/*/", run_dir, fs::path(shard).parent_path().string());
}

std::vector<sweep::RunId> Failed(ResultReader& reader) {
  std::vector<sweep::RunId> failed;
  for (const FailedMission& failure : reader.Failures()) failed.push_back(failure.id);
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

  bool IsComplete() const { return std::ssize(stored_) == reader_.Layout().Missions(); }

  PartOfRun PlanOf(ResultReader& shard) const {
    return FindPlan(reader_.StoredRecipe(), reader_.Layout(), shard);
  }

  // Of a shard whose plan counts. A complete run lacks nothing, whatever a damaged shard's keys say.
  bool Lacks(ResultReader& shard) const {
    return !IsComplete() &&
           (!Includes(stored_, Here(shard, shard.Stored())) || !Includes(known_, Here(shard, Failed(shard))));
  }

 private:
  std::vector<sweep::RunId> Here(const ResultReader& shard, std::vector<sweep::RunId> ids) const {
    if (shard.Layout().SameMissions(reader_.Layout())) return ids;
    for (sweep::RunId& id : ids)
      id = SameMission(shard.Layout(), id, reader_.Layout())
               .value_or(sweep::RunId{-1, -1, -1});  // then it is lacked
    std::sort(ids.begin(), ids.end());
    return ids;
  }

  ResultReader reader_;
  std::vector<sweep::RunId> stored_, known_;
};

// Shards that a complete run is read without, by what is the matter with them.
class LeftOut {
 public:
  explicit LeftOut(std::string run_dir) : run_dir_(std::move(run_dir)) {}

  void Add(const std::string& shard, const PartOfRun& part) {
    Some& some = part.plan == PartPlan::kGrown ? grown_ : part.plan == PartPlan::kMixed ? mixed_ : other_;
    some.Add(shard, part.what);
  }
  void AddUnreadable(const std::string& shard, const std::string& why) { unreadable_.Add(shard, why); }

  std::vector<std::string> Notes() const {
    std::vector<std::string> notes;
    if (grown_.count > 0)
      notes.push_back(fmt::format("{}: {} of a plan that has grown not counted ({}); {}' takes them in",
                                  run_dir_, Shards(grown_.count), grown_.what,
                                  MergeOf(run_dir_, grown_.first)));
    if (mixed_.count > 0)
      notes.push_back(fmt::format("{}: {} of other code not counted ({}); {} --accept-mixed' takes them in",
                                  run_dir_, Shards(mixed_.count), mixed_.what,
                                  MergeOf(run_dir_, mixed_.first)));
    if (other_.count > 0)
      notes.push_back(fmt::format(
          "{}: {} of another plan not counted ({}: {}); take what is of another run out of {}", run_dir_,
          Shards(other_.count), other_.first, other_.what, (fs::path(run_dir_) / "shards").string()));
    if (unreadable_.count > 0)
      notes.push_back(fmt::format("{}: {} that cannot be read not counted ({})", run_dir_,
                                  Shards(unreadable_.count), unreadable_.what));
    return notes;
  }

 private:
  struct Some {
    std::int64_t count = 0;
    std::string first, what;
    void Add(const std::string& shard, const std::string& why) {
      if (count++ == 0) first = shard, what = why;
    }
  };

  std::string run_dir_;
  Some grown_, mixed_, other_, unreadable_;
};

[[noreturn]] void Refuse(const std::string& run_dir, const std::string& shard, const PartOfRun& part) {
  if (part.plan == PartPlan::kGrown)
    throw UserError(fmt::format("{}: its plan has grown beyond that of {} ({}); {}' takes it in", shard,
                                run_dir, part.what, MergeOf(run_dir, shard)));
  if (part.plan == PartPlan::kMixed)
    throw UserError(fmt::format("{}: flown by other code than {} (there): {}; {} --accept-mixed' takes it in",
                                shard, run_dir, part.what, MergeOf(run_dir, shard)));
  throw UserError(fmt::format("{}: of another plan than {} (there): {}; take it out of that folder", shard,
                              run_dir, part.what));
}

}  // namespace

AddingStores StoresThatAdd(const std::string& run_dir) {
  const std::vector<std::string> shards = ShardDirs(run_dir);
  if (!HoldsResults(run_dir)) return {shards, {}};
  AddingStores found{{run_dir}, {}};
  if (shards.empty()) return found;
  const Merged merged(run_dir);
  LeftOut left_out(run_dir);
  const auto look = [&](const std::string& shard) {
    ResultReader reader(shard);
    const PartOfRun part = merged.PlanOf(reader);
    if (part.Counts() && merged.Lacks(reader)) found.dirs.push_back(shard);
    if (part.Counts()) return;
    if (!merged.IsComplete()) Refuse(run_dir, shard, part);
    left_out.Add(shard, part);
  };
  for (const std::string& shard : shards) {
    try {
      look(shard);
    } catch (const UserError& error) {
      if (!merged.IsComplete()) throw;
      left_out.AddUnreadable(shard, error.what());
    }
  }
  found.notes = left_out.Notes();
  return found;
}

GatheredShards::GatheredShards(const std::string& run_dir) : dir_(run_dir) {
  AddingStores found = StoresThatAdd(run_dir);
  notes_ = std::move(found.notes);
  const std::vector<std::string>& stores = found.dirs;
  if (stores.empty() || (stores.size() == 1 && stores.front() == run_dir)) return;
  temporary_.emplace(fs::temp_directory_path());
  dir_ = (temporary_->path() / "run").string();
  MergeStores(dir_, stores);
}

}  // namespace ed3r::store
