// Rows for supervised training, and which of them are held out.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace ed3r::rfnn {

// One row per timestep of the warm-up: raw inputs, the reward that followed, and the mission it belongs to.
// Fill it mission by mission in the order of the plan, never in the order of completion: the order of rows is
// part of the network.
struct DataSet {
  int columns = 0;
  std::vector<float> inputs;  // rows x columns, row-major
  std::vector<float> targets;
  std::vector<std::int64_t> missions;

  explicit DataSet(int columns) : columns(columns) {}

  std::size_t rows() const { return targets.size(); }
  std::span<const float> row(std::size_t r) const {
    return std::span(inputs).subspan(r * static_cast<std::size_t>(columns),
                                     static_cast<std::size_t>(columns));
  }
  // Makes room for so many rows in all.
  void Reserve(std::size_t rows);
  // `row` has `columns` values. A value that is not finite is an InternalError.
  void Add(std::span<const float> row, float target, std::int64_t mission);
};

// SHA-256 of everything in it, rows in order: equal hashes train equal networks.
std::string Fingerprint(const DataSet& data);

// Row numbers, ascending in each part. No mission has rows in two parts: timesteps of one mission resemble
// each other, so that a split by timestep would flatter the held-out error.
struct Split {
  std::vector<std::uint32_t> train, validation, test;
};

// 85 / 10 / 5 percent of the missions (paper: ED3R Configuration Setup), drawn by `seed`; validation and test
// hold one mission at least. The result does not depend on the order of the rows' missions, only on which
// missions there are. Throws UserError for fewer than 3 missions.
Split MakeSplit(std::span<const std::int64_t> missions, std::uint64_t seed);

}  // namespace ed3r::rfnn
