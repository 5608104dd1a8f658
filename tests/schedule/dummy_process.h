// Runs dummy_run as a process, and what tests of it share.
#pragma once

#include <spawn.h>
#include <sys/wait.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "tests/store/store_fixture.h"

extern char** environ;

namespace ed3r::schedule {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

inline constexpr int kMissions = 2000;

class DummyRun {
 public:
  DummyRun(const std::string& dir, int threads, int delay_ms, const std::string& log,
           const std::string& environment = "") {
    std::vector<std::string> words = {
        ED3R_DUMMY_RUN,           dir, std::to_string(kMissions), std::to_string(threads),
        std::to_string(delay_ms), log};
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    std::string extra = environment;
    std::vector<char*> variables;
    for (char** variable = environ; *variable != nullptr; ++variable) variables.push_back(*variable);
    if (!extra.empty()) variables.push_back(extra.data());
    variables.push_back(nullptr);
    EXPECT_EQ(posix_spawn(&process_, ED3R_DUMMY_RUN, nullptr, nullptr, arguments.data(), variables.data()),
              0);
  }
  ~DummyRun() {
    if (running_) Signal(SIGKILL), Wait();
  }
  DummyRun(const DummyRun&) = delete;
  DummyRun& operator=(const DummyRun&) = delete;

  void Signal(int signal) const { kill(process_, signal); }

  // The exit status, or minus the signal that ended it.
  int Wait() {
    int status = 0;
    waitpid(process_, &status, 0);
    running_ = false;
    return WIFSIGNALED(status) ? -WTERMSIG(status) : WEXITSTATUS(status);
  }

 private:
  pid_t process_ = -1;
  bool running_ = true;
};

inline std::int64_t StoredIn(const std::string& dir) {
  try {
    return static_cast<std::int64_t>(store::ResultReader(dir).Stored().size());
  } catch (const UserError&) {  // not begun yet
    return 0;
  }
}

inline void WaitFor(const std::function<bool()>& condition) {
  const auto deadline = steady_clock::now() + std::chrono::seconds(60);
  while (!condition() && steady_clock::now() < deadline) std::this_thread::sleep_for(milliseconds(10));
  ASSERT_TRUE(condition());
}

struct Flown {
  int mission = 0;
  std::int64_t time_ns = 0;
};

inline std::vector<Flown> ReadLog(const std::string& file) {
  std::vector<Flown> flown;
  std::ifstream in(file);
  for (Flown line; in >> line.mission >> line.time_ns;) flown.push_back(line);
  return flown;
}

inline std::string WholeDigest() {
  static const std::string digest = [] {
    const store::TempDir temp;
    store::RunLayout layout = store::TestLayout();
    layout.stages[0].missions = kMissions;
    {
      const auto store = store::ResultStore::Open(temp / "whole", store::TestRecipe(), layout);
      for (int m = 0; m < kMissions; ++m) store->Put({0, 0, m}, store::TestRecord({0, 0, m}), 0);
      store->Commit();
    }
    return store::DigestOfDir(temp / "whole");
  }();
  return digest;
}

}  // namespace ed3r::schedule
