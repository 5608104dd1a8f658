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

inline constexpr std::size_t kMostRows = 1'000'000;

// Missions of one row: numbers first, first + stride, ... of a seed.
struct RowMissions {
  std::uint64_t seed = 0;
  std::int64_t first = 0, stride = 1;
};

struct FleetHandle {
  std::string arm;
  Config config;
  std::shared_ptr<const sweep::SweepPlan>
      plan;  // none where the fleet belongs to a sweep that is being flown
  std::shared_ptr<const schedule::Inputs> inputs;  // likewise
  std::shared_ptr<std::vector<RowMissions>> rows;  // likewise
  std::shared_ptr<schedule::Fleet> fleet;          // last: it refers to the others
  const std::atomic<bool>* stop = nullptr;

  // Begins the next missions, of the rows of `mask` where it is not empty. With a seed, row i begins at mission i of that
  // seed and goes on in strides of the number of rows.
  void Reset(std::span<const std::uint8_t> mask, std::optional<std::uint64_t> seed);
  // Likewise with a seed for each row: where there is one, the row begins at mission 0 of it and goes on in strides of 1, so
  // that equal seeds are equal missions.
  void ResetEach(std::span<const std::uint8_t> mask, std::span<const std::optional<std::uint64_t>> seeds);

  // |dx|, |dy|, |dz| in m, |turn| and largest tilt in rad.
  std::vector<double> LargestCommand() const;
};

// Missions of one arm of a sweep, "ARM" or "STAGE/ARM" ("": the only one), decided from outside whatever its strategy is:
// row i flies missions i, i + rows, i + 2 rows, ... None has begun. `autoreset`: NextStep | SameStep | Disabled,
// Gymnasium's names.
std::shared_ptr<FleetHandle> MakeFleet(const SweepRequest& request, const std::string& arm, std::size_t rows,
                                       int threads, const std::string& autoreset);

}  // namespace ed3r::python
