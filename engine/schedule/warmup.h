// What the networks of an arm learn from: a warm-up that its sweep flies before it (R18).
#pragma once

#include <set>
#include <string>

#include "engine/sweep/plan.h"

namespace ed3r::schedule {

// The arm of a flying stage that an arm's networks learn from, by their numbers in the plan, and the training stages
// that stand behind it and before the learner.
struct WarmupChoice {
  int stage = -1, arm = -1;  // -1 where the plan has none
  std::set<std::string> trainings;

  explicit operator bool() const { return stage >= 0; }
};

// For an arm of `stage` whose strategy asks networks. A warm-up counts only where a training stage stands between it and
// the arm: before that it may not be flown yet.
WarmupChoice ChooseWarmup(const sweep::SweepPlan& plan, const sweep::Stage& stage, const sweep::Arm& learner);

// The warm-up missions that one network learns from: those from `first` up to, not with, `end`.
struct WarmupPart {
  int stage, arm;
  int first, end;
};

// Of the network with the training seed number `seed`, counted from 0: the whole warm-up, or its own part of it with
// training.own_warmups: as many as any other network's, so that some at the end may be left over.
WarmupPart PartOf(const sweep::SweepPlan& plan, const WarmupChoice& warmup, const TrainingConfig& training,
                  int seed);

// UserError where an arm has no warm-up, or one that is too short to be shared out.
void CheckWarmup(const sweep::SweepPlan& plan, const sweep::Stage& stage, const sweep::Arm& learner);

}  // namespace ed3r::schedule
