// The commands of ed3r. Each adds its options to the program and returns the exit status when it is the one
// chosen: 0 done, 1 something failed inside, 2 bad input, 3 finished with failed missions, 75 ended by a batch
// system's signal, 130 interrupted.
#pragma once

#include <functional>

#include "engine/app/command_line.h"

namespace ed3r::app {

using CommandRun = std::function<int()>;

struct Command {
  CommandLine parser;
  CommandRun run;
};

Command AddRun(Program& program);
Command AddPlan(Program& program);
Command AddStatus(Program& program);
Command AddReport(Program& program);
Command AddCompare(Program& program);
Command AddDigest(Program& program);
Command AddMerge(Program& program);
Command AddExport(Program& program);
Command AddVerify(Program& program);
Command AddDiff(Program& program);
Command AddReplay(Program& program);
Command AddExplain(Program& program);
Command AddDetect(Program& program);
Command AddFit(Program& program);
Command AddParams(Program& program);
Command AddPhysics(Program& program);
Command AddWorld(Program& program);
Command AddFrames(Program& program);
Command AddDoctor(Program& program);

constexpr int kDone = 0;
constexpr int kFailedInside = 1;
constexpr int kBadInput = 2;
constexpr int kMissionsFailed = 3;
constexpr int kRequeue = 75;  // EX_TEMPFAIL: the same command continues
constexpr int kInterrupted = 130;

}  // namespace ed3r::app
