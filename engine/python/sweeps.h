// Sweeps as the Python module asks for them.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/sweep/plan.h"

namespace ed3r::python {

struct FleetHandle;

struct SweepRequest {
  std::string file;
  std::vector<std::string> settings;  // KEY=VALUE
  std::optional<std::uint64_t> seed;  // in place of the file's
  std::optional<int> missions;        // per arm, in place of the file's
};

// Throws UserError as 'ed3r run' does.
sweep::SweepPlan LoadRequest(const SweepRequest& request);

// The arms of strategy external, each once, in the plan's order.
std::vector<std::string> OutsideArms(const sweep::SweepPlan& plan);

struct FlightPlace {
  std::string out;              // run directory
  std::string cache;            // of trained networks
  std::string policy_identity;  // what makes the same decisions has the same
  std::size_t rows = 64;        // missions side by side
  int threads = 0;
};

struct FlightCount {
  std::int64_t stored = 0;  // in this call
  std::int64_t failed = 0;
};

// Steps the fleet until all of its rows have retired.
using DriveFn = std::function<void(const std::shared_ptr<FleetHandle>& fleet)>;

// Flies what is missing of the sweep into place.out, as 'ed3r run' does; `drive` is called once for each arm of strategy
// external that has missions to fly. Missions fly on threads of their own: the calling one calls `drive`, and `heed` several
// times a second else. Throws UserError, and what `drive` and `heed` throw, which ends the flight; what was flown is kept.
FlightCount FlyWithPolicy(const SweepRequest& request, const FlightPlace& place, const DriveFn& drive,
                          const std::function<void()>& heed);

}  // namespace ed3r::python
