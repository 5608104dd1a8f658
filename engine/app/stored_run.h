// A run directory brought back to life: its plan, inputs and networks, so that a stored mission can be flown again.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "engine/app/sweep_arguments.h"
#include "engine/schedule/sweep_runner.h"
#include "engine/store/reader.h"

namespace ed3r {

// Notes from which StoredRun finds the sweep again; stored with each session.
std::map<std::string, std::string> NotesOf(const SweepArguments& arguments);

class StoredRun {
 public:
  // Loads the sweep that the run was made from and checks that it is still the same plan and code. Throws UserError
  // that says what has changed.
  StoredRun(const std::string& dir, const std::string& cache_dir);

  // "ARM/NUMBER" or "STAGE/ARM/NUMBER", numbers from 0. Throws UserError that names the nearest arm or lists them.
  RunId Find(const std::string& mission) const;

  // Trains or finds the networks where the mission's strategy asks any.
  MissionTask Task(const RunId& id);

  ResultReader& Reader() { return reader_; }
  const SweepPlan& Plan() const { return plan_; }
  const Inputs& SharedInputs() const { return inputs_; }

 private:
  ResultReader reader_;
  std::string cache_dir_;
  SweepPlan plan_;
  Inputs inputs_;
  std::unique_ptr<NetworkShelf> networks_;
};

}  // namespace ed3r
