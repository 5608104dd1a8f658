// The arms of the paper's evaluation: what its claims, tables and figures speak of.
//
// Threads: all functions may be called from any thread.
#pragma once

#include <span>
#include <string_view>
#include <vector>

namespace ed3r {

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

// The warm-up that flies this strategy, whatever it is called; null where none does.
const PaperArm* FindPaperWarmup(std::string_view strategy);

}  // namespace ed3r
