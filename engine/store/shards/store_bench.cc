// How fast and how large the store is, on as many rows as the paper's whole study: prints one line per
// measure.
//   build/bench/engine/store/shards/store_bench [MISSIONS [TIMESTEPS]]
//   build/bench/engine/store/shards/store_bench MISSIONS TIMESTEPS SHARDS [DIR]    merges as many stores, and nothing else; with DIR
//       they stay there, and are merged again by the next call
#include <fmt/format.h>
#include <sys/resource.h>

#include <chrono>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <type_traits>
#include <vector>

#include "engine/core/random.h"
#include "engine/store/checksums.h"
#include "engine/store/columns.h"
#include "engine/store/digest.h"
#include "engine/store/reader.h"
#include "engine/store/schema.h"
#include "engine/store/shards/merge.h"
#include "engine/store/store.h"
#include "engine/store/tally.h"

namespace ed3r::store {
namespace {

// Fractions without structure, as measured figures are; a fifth of the columns is zero at each timestep (a
// move is up or down, a picture is sent or computed on).
template <class Record>
void Fill(Stream& stream, Record& record) {
  Record::Describe(record, [&](std::string_view, auto& field) {
    if constexpr (std::is_same_v<std::remove_cvref_t<decltype(field)>, double>)
      field = stream.Below(5) == 0 ? 0.0 : stream.Uniform(0, 1000);
    else
      field = stream.Below(6);
  });
}

mission::MissionRecord Draw(std::uint32_t mission, int timesteps) {
  Stream stream(1, mission, Purpose::kScenario);
  mission::MissionRecord record;
  Fill(stream, record);
  for (int k = 1; k <= timesteps; ++k) {
    Fill(stream, record.steps.emplace_back());
    record.steps.back().k = k;
  }
  return record;
}

class Stopwatch {
 public:
  double Seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  }

 private:
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

// Of this process: ratios of it hold on a machine that others use, too.
class ProcessorWatch {
 public:
  double Seconds() const { return static_cast<double>(std::clock() - begin_) / CLOCKS_PER_SEC; }

 private:
  std::clock_t begin_ = std::clock();
};

double ThisThread_s() {
  timespec time = {};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec) * 1e-9;
}

void PrintChecksumShare(const RecordTables& tables, const RunLayout& layout,
                        const std::vector<mission::MissionRecord>& records, double puts_s) {
  const ProcessorWatch sums;
  std::size_t digits = 0;
  for (std::size_t i = 0; i < records.size(); ++i)
    digits += tables.Of(layout, {0, 0, static_cast<int>(i)}, records[i]).mission.size();
  fmt::print("checksums          {:8.1f} % of putting ({} digits)\n", 100 * sums.Seconds() / puts_s, digits);
}

// The same rows as the reader gives, by the same statements, compared with nothing.
double ReadUnchecked(const std::string& dir, double& sum) {
  Connection database((std::filesystem::path(dir) / kResultsFile).string(), Connection::Access::kReadOnly);
  const RecordTables tables(database);
  const ProcessorWatch watch;
  Statement missions(database, fmt::format("SELECT mission, {} FROM missions ORDER BY run, mission",
                                           tables.missions().selection()));
  Statement steps(database, fmt::format("SELECT {} FROM timesteps WHERE run = 0 AND mission = ? ORDER BY k",
                                        tables.timesteps().selection()));
  mission::MissionRecord record;
  while (missions.Step()) {
    ReadColumns(missions, 1, record);
    record.steps.clear();
    steps.Bind(0, missions.Int(0));
    while (steps.Step()) ReadColumns(steps, 0, record.steps.emplace_back());
    steps.Reset();
    for (const mission::TimestepRecord& step : record.steps) sum += step.total_j;
  }
  return watch.Seconds();
}

void Write(const std::string& dir, const RunLayout& layout, int missions, int timesteps) {
  std::vector<mission::MissionRecord> records;
  for (int i = 0; i < missions; ++i) records.push_back(Draw(static_cast<std::uint32_t>(i), timesteps));
  const double rows = 1.0 * missions * timesteps;
  const Stopwatch all;
  auto store = ResultStore::Open(dir, {}, layout);
  const Stopwatch puts;
  const ProcessorWatch putting;
  for (int i = 0; i < missions; ++i) {
    store->Put({0, 0, i}, records[static_cast<std::size_t>(i)], 1.0);
    if (i % 400 == 399) store->Commit();
  }
  store->Commit();
  const double putting_s = putting.Seconds();
  fmt::print("put and commit     {:8.0f} rows/s\n", rows / puts.Seconds());
  Connection database((std::filesystem::path(dir) / kResultsFile).string(), Connection::Access::kReadOnly);
  PrintChecksumShare(RecordTables(database), layout, records, putting_s);
  store.reset();
  fmt::print("open to close      {:8.0f} rows/s\n", rows / all.Seconds());
  const auto bytes = std::filesystem::file_size(std::filesystem::path(dir) / kResultsFile);
  fmt::print("file               {:8.1f} MB, {:.0f} bytes/row\n", static_cast<double>(bytes) / 1e6,
             static_cast<double>(bytes) / rows);
}

void Read(const std::string& dir, double rows) {
  ResultReader reader(dir);
  const Stopwatch steps;
  const ProcessorWatch checking;
  double sum = 0;
  reader.ForEachTimestep(0, 0, [&](int, const mission::TimestepRecord& step) { sum += step.total_j; });
  const double checked_s = checking.Seconds();
  fmt::print("timesteps read     {:8.0f} rows/s (sum {:.6g})\n", rows / steps.Seconds(), sum);
  double again = 0;
  const double unchecked_s = ReadUnchecked(dir, again);
  fmt::print("without checksums  {:8.2f} times less processor time (sum {:.6g})\n", checked_s / unchecked_s,
             again);
  const Stopwatch digest;
  const std::string text = DigestOf(reader);
  fmt::print("digest             {:8.0f} rows/s ({:.2f} s, {:.8})\n", rows / digest.Seconds(),
             digest.Seconds(), text);
  const Stopwatch status;
  const auto done = reader.Status().front().done;
  fmt::print("status, compared   {:8.1f} ms ({} done)\n", 1e3 * status.Seconds(), done);
  const Stopwatch tally;
  Tally counted(reader.StoredRecipe(), reader.Layout());
  counted.Add(dir);
  fmt::print("status, counted    {:8.1f} ms ({} done)\n", 1e3 * tally.Seconds(), counted.Arms().front().done);
}

double PeakMemory_mb() {
  rusage usage = {};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

// Missions dealt among the shards as a batch system's tasks fly them.
void Merge(const std::string& dir, const RunLayout& layout, int missions, int timesteps, int shards) {
  std::vector<std::string> dirs;
  for (int shard = 0; shard < shards; ++shard) {
    dirs.push_back(fmt::format("{}/shards/online/{:05}", dir, shard));
    if (std::filesystem::exists(dirs.back())) continue;
    auto store = ResultStore::Open(dirs.back(), {}, layout);
    for (int i = shard; i < missions; i += shards)
      store->Put({0, 0, i}, Draw(static_cast<std::uint32_t>(i), timesteps), 1.0);
    store->Commit();
  }
  std::filesystem::remove_all(dir + "/merged");
  const double before_mb = PeakMemory_mb();
  const auto timed = [&](const char* what) {
    const Stopwatch wall;
    const ProcessorWatch processor;
    const double thread_before_s = ThisThread_s();
    const MergeSummary summary = MergeStores(dir + "/merged", dirs);
    fmt::print(
        "{:<18} {:8.1f} s of processor time, {:.1f} s of it in the thread that puts, {:.1f} s of wall time "
        "({} added, {} present)\n",
        what, processor.Seconds(), ThisThread_s() - thread_before_s, wall.Seconds(), summary.added,
        summary.present);
  };
  timed(fmt::format("merge of {} stores", shards).c_str());
  fmt::print("peak memory        {:8.0f} MB before, {:.0f} MB after\n", before_mb, PeakMemory_mb());
  timed("merged again");
  const Stopwatch tally;
  Tally all({}, layout);
  for (const std::string& store : dirs) all.Add(store);
  fmt::print("tally of shards    {:8.1f} ms ({} done)\n", 1e3 * tally.Seconds(), all.Arms().front().done);
}

}  // namespace
}  // namespace ed3r::store

int main(int argc, char** argv) {
  const int missions = argc > 1 ? std::atoi(argv[1]) : 11000;
  const int timesteps = argc > 2 ? std::atoi(argv[2]) : 30;
  const auto dir = std::filesystem::temp_directory_path() / fmt::format("ed3r_store_bench_{}", missions);
  std::filesystem::remove_all(dir);
  const ed3r::store::RunLayout layout{
      .name = "bench", .seed = 1, .stages = {{.name = "s", .missions = missions, .arms = {{"a", 0}}}}};
  if (argc > 4) {
    ed3r::store::Merge(argv[4], layout, missions, timesteps, std::atoi(argv[3]));
  } else if (argc > 3) {
    ed3r::store::Merge(dir.string(), layout, missions, timesteps, std::atoi(argv[3]));
  } else {
    ed3r::store::Write(dir.string(), layout, missions, timesteps);
    ed3r::store::Read(dir.string(), 1.0 * missions * timesteps);
  }
  std::filesystem::remove_all(dir);
}
