// The arms of the paper's evaluation: what its claims, tables and figures speak of.
//
// Threads: all functions may be called from any thread.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace ed3r::paper {

// Missions of an online arm and of the warm-up in the paper.
inline constexpr int kPaperOnlineMissions = 850, kPaperWarmupMissions = 2040;

struct PaperArm {
  std::string_view name;      // "ed3r-75"
  std::string_view label;     // "ED³R-75", UTF-8
  std::string_view strategy;  // of engine/agents/strategy.h
  double eta_min = 0.75;      // the detection threshold that it flies with
  bool warmup = false;        // flown at the known sites before training
  bool learns = false;        // asks networks that are trained
};

// In the order of the paper's tables, warm-ups first.
std::span<const PaperArm> PaperArms();

// Null where the paper has no arm of that name.
const PaperArm* FindPaperArm(std::string_view name);

// What the paper compares side by side, in its order: its Results 1 to 3.
struct PaperComparison {
  std::string_view id;                     // "thresholds", "ablations", "baselines"
  std::span<const std::string_view> arms;  // names, as the paper orders them
};
std::span<const PaperComparison> PaperComparisons();
// ED3R_CHECK that there is one of that id.
std::span<const std::string_view> ArmsOfComparison(std::string_view id);

// The paper's name of an arm's P85 group, its 15 % longest missions: "ed3r-p85" for ed3r-75, the threshold that it goes on
// with, "rbs-p85" for rbs.
std::string P85Name(std::string_view arm);
bool IsP85Name(std::string_view name);
// The arm whose P85 group is called `name`; `name` itself where it is none.
std::string_view ArmOfP85Name(std::string_view name);

// The warm-up that flies this strategy, whatever it is called; null where none does.
const PaperArm* FindPaperWarmup(std::string_view strategy);

}  // namespace ed3r::paper
