// Fleets (engine/schedule/fleet.h) with what they fly in.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/python/sweeps.h"
#include "engine/schedule/fleet.h"
#include "engine/schedule/inputs.h"

namespace ed3r::python {

struct FleetHandle {
  std::string arm;
  Config config;
  std::shared_ptr<sweep::SweepPlan> plan;  // none where the fleet belongs to a sweep that is being flown
  std::shared_ptr<const schedule::Inputs> inputs;  // likewise
  std::shared_ptr<schedule::Fleet> fleet;          // last: it refers to the others
  const std::atomic<bool>* stop = nullptr;

  // Begins the next missions, or with a seed the first ones of that seed; only the rows of `mask` where it marks any.
  void Reset(std::span<const std::uint8_t> mask, std::optional<std::uint64_t> seed);

  // |dx|, |dy|, |dz| in m, |turn| and largest tilt in rad.
  std::vector<double> LargestCommand() const;
};

// Missions of one arm of a sweep, "ARM" or "STAGE/ARM" ("": the only one), decided from outside whatever its strategy is:
// row i flies missions i, i + rows, i + 2 rows, ... None has begun. `autoreset`: next_step | same_step | disabled.
std::shared_ptr<FleetHandle> MakeFleet(const SweepRequest& request, const std::string& arm, std::size_t rows,
                                       int threads, const std::string& autoreset);

}  // namespace ed3r::python
