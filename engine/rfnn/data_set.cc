#include "engine/rfnn/data_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/core/check.h"
#include "engine/core/sha256.h"
#include "engine/rfnn/training_draws.h"

namespace ed3r::rfnn {
namespace {

constexpr double kValidationShare = 0.10;
constexpr double kTestShare = 0.05;

std::size_t ShareOf(std::size_t missions, double share) {
  return std::max<std::size_t>(1,
                               static_cast<std::size_t>(std::lround(share * static_cast<double>(missions))));
}

}  // namespace

void DataSet::Reserve(std::size_t rows) {
  inputs.reserve(rows * static_cast<std::size_t>(columns));
  targets.reserve(rows);
  missions.reserve(rows);
}

void DataSet::Add(std::span<const float> row, float target, std::int64_t mission) {
  ED3R_CHECK(row.size() == static_cast<std::size_t>(columns), fmt::format("{} values", row.size()));
  for (const float value : row)
    ED3R_CHECK(std::isfinite(value), fmt::format("mission {}, input {}", mission, value));
  ED3R_CHECK(std::isfinite(target), fmt::format("mission {}, target {}", mission, target));
  inputs.insert(inputs.end(), row.begin(), row.end());
  targets.push_back(target);
  missions.push_back(mission);
}

std::string Fingerprint(const DataSet& data) {
  Sha256 hash;
  hash.Update(fmt::format("{} x {}\n", data.rows(), data.columns));
  hash.Update(data.inputs.data(), data.inputs.size() * sizeof(float));
  hash.Update(data.targets.data(), data.targets.size() * sizeof(float));
  hash.Update(data.missions.data(), data.missions.size() * sizeof(std::int64_t));
  return hash.Hex();
}

Split MakeSplit(std::span<const std::int64_t> missions, std::uint64_t seed) {
  std::vector<std::int64_t> order(missions.begin(), missions.end());
  std::sort(order.begin(), order.end());
  order.erase(std::unique(order.begin(), order.end()), order.end());
  if (order.size() < 3)
    throw UserError(
        fmt::format("training: the warm-up holds rows of {} missions; at least 3, one each to train, "
                    "validate and test on",
                    order.size()));
  Shuffle(order, TrainingStream(seed, TrainingDraw::kSplit));
  const auto test_end = order.begin() + static_cast<std::ptrdiff_t>(ShareOf(order.size(), kTestShare));
  const auto validation_end = test_end + static_cast<std::ptrdiff_t>(ShareOf(order.size(), kValidationShare));
  std::sort(order.begin(), test_end);
  std::sort(test_end, validation_end);
  Split split;
  for (std::size_t r = 0; r < missions.size(); ++r) {
    std::vector<std::uint32_t>* part = &split.train;
    if (std::binary_search(order.begin(), test_end, missions[r])) part = &split.test;
    if (std::binary_search(test_end, validation_end, missions[r])) part = &split.validation;
    part->push_back(static_cast<std::uint32_t>(r));
  }
  return split;
}

}  // namespace ed3r::rfnn
