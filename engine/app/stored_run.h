// A run directory brought back to life: its plan, inputs and networks, so that a stored mission can be flown again.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "engine/app/sweep_arguments.h"
#include "engine/schedule/sweep_runner.h"
#include "engine/store/reader.h"
#include "engine/store/restored_files.h"
#include "engine/store/shards/gathered_shards.h"

namespace ed3r::app {

// How the sweep was asked for, for people who read a report; stored with each session.
std::map<std::string, std::string> NotesOf(const SweepArguments& arguments);

class StoredRun {
 public:
  // Builds the plan and its worlds from what the run directory keeps, and nothing else; shards in it count, merged or not.
  // Throws UserError where this is other code than that which flew.
  StoredRun(const std::string& dir, const std::string& cache_dir);

  // "ARM/NUMBER", of an arm that one stage alone has, or "STAGE/ARM/NUMBER", numbers from 0. Throws UserError that names the
  // nearest arm or lists them.
  sweep::RunId Find(const std::string& mission) const;

  // With the networks that flew, where the mission's strategy asks any; a run of format 1 keeps none, so that they are
  // trained or found again.
  mission::MissionTask Task(const sweep::RunId& id);

  store::ResultReader& Reader() { return reader_; }
  // On shards that do not count.
  const std::vector<std::string>& Notes() const { return gathered_.notes(); }
  const sweep::SweepPlan& Plan() const { return plan_; }
  const schedule::Inputs& SharedInputs() const { return inputs_; }

 private:
  std::string dir_;
  store::GatheredShards gathered_;
  store::ResultReader reader_;
  std::string cache_dir_;
  store::RestoredFiles files_;
  sweep::SweepPlan plan_;
  schedule::Inputs inputs_;
  std::unique_ptr<schedule::NetworkShelf> networks_;
};

}  // namespace ed3r::app
