// A sweep whose missions only sleep, as a process of its own: for tests that kill, interrupt and limit it.
//   dummy_run DIR MISSIONS THREADS DELAY_MS LOG
// Appends one line per mission flown to LOG: its number and the time on the monotonic clock in ns.
// Exit status as `ed3r run`.
#include <fcntl.h>

#include <cstdlib>
#include <iostream>
#include <thread>

#include "engine/core/interrupt.h"
#include "engine/schedule/scheduler.h"
#include "engine/schedule/todo.h"
#include "tests/store/store_fixture.h"

namespace ed3r::schedule {
namespace {

int Run(const std::string& dir, int missions, int threads, int delay_ms, const char* log_file) {
  InstallInterruptHandler();
  store::RunLayout layout = store::TestLayout();
  layout.stages[0].missions = missions;
  const int log = open(log_file, O_WRONLY | O_CREAT | O_APPEND, 0600);
  const auto store = store::ResultStore::Open(dir, store::TestRecipe(), layout);
  const auto fly = [&](const sweep::RunId& id, const std::atomic<bool>& stop) {
    for (int slept_ms = 0; slept_ms < delay_ms; ++slept_ms) {
      if (stop) throw Interrupted();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    mission::MissionRecord record = store::TestRecord(id);
    const std::string line =
        fmt::format("{} {}\n", id.mission, std::chrono::steady_clock::now().time_since_epoch().count());
    if (write(log, line.data(), line.size()) < 0) throw std::runtime_error("log");
    return record;
  };
  const RunSummary summary = RunMissions(Todo(layout, 0, Shard{}, store->Stored()), fly, *store,
                                         {.threads = threads, .stop = &InterruptFlag()});
  if (summary.interrupted) return AsksRequeue(InterruptSignal()) ? 75 : 130;
  return summary.failed > 0 ? 3 : 0;
}

}  // namespace
}  // namespace ed3r::schedule

int main(int argc, char** argv) {
  if (argc != 6) return 1;
  try {
    return ed3r::schedule::Run(argv[1], std::atoi(argv[2]), std::atoi(argv[3]), std::atoi(argv[4]), argv[5]);
  } catch (const ed3r::UserError& error) {
    std::cerr << error.what() << "\n";
    return 2;
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
}
