// The commands of ed3r. Each adds its options to the program and returns the exit status when it is the one
// chosen: 0 done, 1 something failed inside, 2 bad input, 3 finished with failed missions, 75 ended by a batch
// system's signal, 130 interrupted.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

namespace ed3r {

using CommandRun = std::function<int()>;

struct Command {
  CLI::App* parser = nullptr;
  CommandRun run;
};

Command AddRun(CLI::App& program);
Command AddPlan(CLI::App& program);
Command AddStatus(CLI::App& program);
Command AddReport(CLI::App& program);
Command AddCompare(CLI::App& program);
Command AddDigest(CLI::App& program);
Command AddMerge(CLI::App& program);
Command AddVerify(CLI::App& program);
Command AddDiff(CLI::App& program);
Command AddReplay(CLI::App& program);
Command AddExplain(CLI::App& program);
Command AddDetect(CLI::App& program);
Command AddFit(CLI::App& program);
Command AddParams(CLI::App& program);
Command AddPhysics(CLI::App& program);
Command AddWorld(CLI::App& program);
Command AddFrames(CLI::App& program);
Command AddDoctor(CLI::App& program);

// For options that take a path: an empty one is a variable that was not set.
inline CLI::Validator NotEmpty() {
  return CLI::Validator(
      [](std::string& text) { return std::string(text.empty() ? "'' is not allowed; allowed: a path" : ""); },
      "");
}

constexpr int kDone = 0;
constexpr int kFailedInside = 1;
constexpr int kBadInput = 2;
constexpr int kMissionsFailed = 3;
constexpr int kRequeue = 75;  // EX_TEMPFAIL: the same command continues
constexpr int kInterrupted = 130;

}  // namespace ed3r
