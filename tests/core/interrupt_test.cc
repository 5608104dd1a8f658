#include "engine/core/interrupt.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <filesystem>
#include <string>
#include <vector>

#include "engine/core/files/file.h"
#include "engine/core/files/temporary_file.h"

namespace ed3r {
namespace {

namespace fs = std::filesystem;

constexpr int kAll[] = {SIGINT, SIGTERM, SIGHUP, SIGUSR1, SIGUSR2, SIGXCPU};

// Each test in a process of its own, because signals and the flag belong to the process.
TEST(InterruptTest, ASignalSetsTheFlagAndASecondCtrlCEndsTheProcess) {
  for (const int signal : kAll)
    EXPECT_EXIT(
        {
          InstallInterruptHandler();
          if (InterruptFlag() || InterruptSignal() != 0) _exit(1);
          std::raise(signal);
          if (!InterruptFlag() || InterruptSignal() != signal) _exit(2);
          if (AsksRequeue(signal) != (signal != SIGINT)) _exit(3);
          std::raise(SIGTERM);  // a batch system may send several; the first one counts
          if (InterruptSignal() != signal) _exit(4);
          std::raise(SIGINT);
          if (signal != SIGINT) std::raise(SIGINT);
          _exit(5);
        },
        ::testing::KilledBySignal(SIGINT), "^$");
}

TEST(InterruptTest, BeforeThereIsWorkASignalEndsTheProcessWithALineAndAStatus) {
  for (const int signal : kAll)
    EXPECT_EXIT(
        {
          EndOnInterrupt({.interrupted = 130, .requeue = 75});
          std::raise(signal);
        },
        ::testing::ExitedWithCode(signal == SIGINT ? 130 : 75),
        signal == SIGINT
            ? "^ed3r: interrupted\n$"
            : std::string("^ed3r: ended by ") + SignalName(signal) + "; the same command continues\n$");
}

TEST(InterruptTest, ASignalThatEndsTheProcessTakesWhatIsTemporary) {
  // Not a TemporaryFolder: the process that ends would take it too.
  const fs::path scratch = fs::temp_directory_path() / fmt::format("ed3r-test-{}", getpid());
  fs::create_directory(scratch);
  EXPECT_EXIT(
      {
        const AtomicFile written(scratch / "half");
        AtomicFile whole(scratch / "whole");
        whole.Write("all of it");
        whole.Commit();
        const TemporaryFolder files(scratch);
        fs::create_directories(files.path() / "a" / "b");
        WriteFile(files.path() / "x", "1");
        WriteFile(files.path() / "a" / "b" / "y", "2");
        fs::create_directory_symlink(scratch, files.path() / "link");
        EndOnInterrupt({.interrupted = 130, .requeue = 75});
        std::raise(SIGINT);
      },
      ::testing::ExitedWithCode(130), "^ed3r: interrupted\n$");
  std::vector<std::string> left;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(scratch))
    left.push_back(entry.path().filename().string());
  EXPECT_EQ(left, std::vector<std::string>{"whole"});
  fs::remove_all(scratch);
}

TEST(InterruptTest, WorkThatDoesNotLookAtTheFlagIsEndedAfterABatchSystemsSignal) {
  EXPECT_EXIT(
      {
        EndOnInterrupt({.interrupted = 130, .requeue = 75});
        InstallInterruptHandler();
        std::raise(SIGUSR1);
        if (alarm(1) == 0) _exit(1);  // nobody would end it
        while (true) pause();
      },
      ::testing::ExitedWithCode(75), "^ed3r: ended by SIGUSR1; the same command continues\n$");
}

TEST(InterruptTest, ASignalThatIsRepeatedPutsTheEndOffNoFurther) {
  EXPECT_EXIT(
      {
        EndOnInterrupt({.interrupted = 130, .requeue = 75});
        InstallInterruptHandler();
        std::raise(SIGTERM);
        alarm(1);  // what is left of the four seconds
        for (int i = 0; i < 6; ++i) {
          std::raise(SIGTERM);
          usleep(500'000);
        }
      },
      ::testing::ExitedWithCode(75), "^ed3r: ended by SIGTERM; the same command continues\n$");
}

TEST(InterruptTest, ALimitOfProcessorTimeIsToldLikeABatchSystemsSignal) {
  EXPECT_EXIT(
      {
        EndOnInterrupt({.interrupted = 130, .requeue = 75});
        rlimit limit = {};
        getrlimit(RLIMIT_CPU, &limit);
        limit.rlim_cur = 1;
        if (setrlimit(RLIMIT_CPU, &limit) != 0) _exit(1);
        for (std::atomic<int> turns = 0;;) ++turns;
      },
      ::testing::ExitedWithCode(75), "^ed3r: ended by SIGXCPU; the same command continues\n$");
}

TEST(InterruptTest, UnderNohupAClosedTerminalIsNoReasonToEnd) {
  EXPECT_EXIT(
      {
        std::signal(SIGHUP, SIG_IGN);
        EndOnInterrupt({.interrupted = 130, .requeue = 75});
        std::raise(SIGHUP);
        InstallInterruptHandler();
        std::raise(SIGHUP);
        _exit(InterruptFlag() ? 1 : 0);
      },
      ::testing::ExitedWithCode(0), "^$");
}

}  // namespace
}  // namespace ed3r
