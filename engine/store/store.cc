#include "engine/store/store.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <optional>
#include <utility>

#include "engine/core/check.h"
#include "engine/store/damage.h"
#include "engine/store/growth.h"
#include "engine/store/records.h"
#include "engine/store/schema.h"
#include "engine/store/sqlite.h"
#include "engine/store/store_file.h"

namespace ed3r::store {
namespace {

std::string UtcNow() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  std::tm parts = {};
  gmtime_r(&now, &parts);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text;
}

std::string HostName() {
  char name[256] = {};
  return gethostname(name, sizeof name - 1) == 0 ? name : "unknown";
}

class SqliteStore final : public ResultStore {
 public:
  SqliteStore(const std::string& dir, const Recipe& recipe, const RunLayout& layout, const Taking& taking)
      : layout_(layout), there_(layout), file_(dir, recipe, layout, taking) {
    if (file_.grown().empty()) {
      Transaction transaction(file_.database(), Transaction::Kind::kWrite);
      file_.TakeUp(recipe, layout_);
      transaction.Commit();
      writer_.emplace(file_.database(), layout_);
    } else {
      there_ = ReadLayout(file_.database());
      arms_here_ = ArmsAfterGrowth(there_, layout_);
      waiting_ = recipe;
    }
    BeginSession(recipe);
  }

  ~SqliteStore() override {
    if (discarded_) return;
    try {
      group_.reset();
      Statement end(file_.database(), "UPDATE sessions SET ended_utc = ? WHERE session = ?");
      end.Run(UtcNow(), session_);
    } catch (const std::exception&) {  // a full disk: the session stays without an end, as after a kill
    }
  }

  const RunLayout& Layout() const override { return layout_; }

  std::string Grown() const override { return file_.grown(); }

  std::vector<DamagedMission> Repaired() const override { return file_.repaired(); }

  bool HasGrown() const override { return !file_.grown().empty() && !waiting_; }

  void Grow() override {
    if (!waiting_) return;
    InGroup([&] { TakeUpPlan(); });
    Commit();
  }

  std::vector<sweep::RunId> Stored() const override { return AsHere(ReadStored(file_.database(), there_)); }

  void Put(const sweep::RunId& id, const mission::MissionRecord& record, double wall_s) override {
    CheckStorable(record);
    ED3R_CHECK(layout_.Contains(id), fmt::format("{}/{}/{}", id.stage, id.arm, id.mission));
    InGroup([&] {
      TakeUpPlan();
      writer_->InsertMission(id, record);
      writer_->InsertTiming(id, session_, wall_s);
    });
  }

  std::vector<sweep::RunId> Failed() const override {
    std::vector<sweep::RunId> failed;
    for (const FailedMission& failure : ReadFailures(file_.database(), there_)) failed.push_back(failure.id);
    return AsHere(std::move(failed));
  }

  FlownNetworks Networks() const override {
    FlownNetworks networks = ReadNetworks(file_.database(), there_);
    for (NetworkUse& use : networks.uses) use.arm = ArmHere(use.stage, use.arm);
    return networks;
  }

  void PutFailure(const sweep::RunId& id, const Failure& failure) override {
    const std::int64_t scenario = layout_.Scenario(id);  // throws before the group is touched
    InGroup([&] {
      TakeUpPlan();
      writer_->InsertFailure(id, scenario, layout_.seed, failure);
    });
  }

  std::vector<DamagedMission> FindDamage() override {
    return ed3r::store::FindDamage(file_.database(), there_);
  }

  void Remove(const std::vector<DamagedMission>& missions) override {
    InGroup([&] { RemoveMissions(file_.database(), missions); });
    Commit();
  }

  void PutNetworks(const FlownNetworks& networks) override {
    InGroup([&] {
      TakeUpPlan();
      ed3r::store::PutNetworks(file_.database(), layout_, networks);
    });
    Commit();
  }

  void PutNote(const std::string& name, const std::string& text) override {
    InGroup([&] {
      Statement(file_.database(),
                "INSERT OR REPLACE INTO session_notes (session, key, value) VALUES (?, ?, ?)")
          .Run(session_, name, text);
    });
  }

  void Commit() override {
    InGroup([&] {
      file_.CheckInPlace();
      group_->Commit();
      file_.CheckInPlace();
    });
    group_.reset();
  }

  void DiscardUnused() override {
    if (!file_.created() ||
        file_.database().Int("SELECT (SELECT count(*) FROM missions) + (SELECT count(*) FROM "
                             "failures) + (SELECT count(*) FROM networks)") > 0)
      return;
    broken_ = discarded_ = true;
    group_.reset();
    writer_.reset();
    file_.Discard();
  }

 private:
  void BeginSession(const Recipe& recipe) {
    Connection& database = file_.database();
    Transaction transaction(database, Transaction::Kind::kWrite);
    WriteFirstPage(database);
    // Drawn, not counted: sessions of many stores meet in a merge.
    session_ = database.Int("SELECT random() & 0x7fffffffffffffff");
    Statement begin(database, "INSERT INTO sessions (session, host, process, begun_utc) VALUES (?, ?, ?, ?)");
    begin.Run(session_, HostName(), static_cast<std::int64_t>(getpid()), UtcNow());
    Statement note(database, "INSERT INTO session_notes (session, key, value) VALUES (?, ?, ?)");
    for (const auto& [key, value] : recipe.notes) note.Run(session_, key, value);
    transaction.Commit();
  }

  // Of an arm of the file in the plan that it will have.
  int ArmHere(int stage, int arm) const {
    if (!waiting_) return arm;
    return arms_here_.at(static_cast<std::size_t>(stage)).at(static_cast<std::size_t>(arm));
  }

  std::vector<sweep::RunId> AsHere(std::vector<sweep::RunId> missions) const {
    if (!waiting_) return missions;
    for (sweep::RunId& id : missions) id.arm = ArmHere(id.stage, id.arm);
    std::sort(missions.begin(), missions.end());
    return missions;
  }

  // In the open group, where the plan waits to grow. Keys of before are not those of after: the writer is made anew.
  void TakeUpPlan() {
    if (!waiting_) return;
    file_.TakeUp(*waiting_, layout_);
    writer_.emplace(file_.database(), layout_);
    there_ = layout_;
    waiting_.reset();
  }

  void BeginGroup() {
    file_.CheckInPlace();
    group_.emplace(file_.database(), Transaction::Kind::kWrite);
    WriteFirstPage(file_.database());
  }

  // Runs `write` inside the open group. A write that fails may have got half-way, so the whole group goes
  // and the store is closed to further writes: no later commit can keep half a mission.
  template <class Write>
  void InGroup(const Write& write) {
    ED3R_CHECK(!broken_, "a write to this store failed before");
    try {
      file_.CheckOwned();
      if (!group_) BeginGroup();
      write();
    } catch (...) {
      broken_ = true;
      group_.reset();
      throw;
    }
  }

  RunLayout layout_;
  RunLayout there_;                          // of what is in the file: until that grows, another
  std::vector<std::vector<int>> arms_here_;  // while it waits to grow
  mutable StoreFile file_;                   // reading moves SQLite's cursors
  std::optional<RecordWriter> writer_;       // none before it has grown, nor once it is discarded
  std::optional<Recipe> waiting_;            // to be taken up with what is put first
  std::optional<Transaction> group_;         // since the last commit
  std::int64_t session_ = 0;
  bool broken_ = false, discarded_ = false;
};

}  // namespace

std::unique_ptr<ResultStore> ResultStore::Open(const std::string& dir, const Recipe& recipe,
                                               const RunLayout& layout, const Taking& taking) {
  return std::make_unique<SqliteStore>(dir, recipe, layout, taking);
}

}  // namespace ed3r::store
