#include "engine/schedule/todo.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <utility>

#include "engine/core/check.h"
#include "engine/core/random.h"

namespace ed3r::schedule {
namespace {

bool ParseNumber(std::string_view text, std::int64_t& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

// Which shard a deal begins with: multiples of the golden section as a 64-bit fraction, which spread evenly and recur never.
std::int64_t FirstShardOf(std::int64_t deal, std::int64_t count) {
  const std::uint64_t fraction = static_cast<std::uint64_t>(deal) * 0x9e3779b97f4a7c15;
  return static_cast<std::int64_t>(((fraction >> 32) * static_cast<std::uint64_t>(count)) >> 32);
}

}  // namespace

Shard ParseShard(std::string_view text) {
  const std::size_t slash = text.find('/');
  std::int64_t index = 0, count = 0;
  if (slash == std::string_view::npos || !ParseNumber(text.substr(0, slash), index) ||
      !ParseNumber(text.substr(slash + 1), count) || count < 1 || index < 0 || index > count)
    throw UserError(fmt::format("--shard: \"{}\" is not I/N with 0 <= I <= N and N >= 1, such as 1/4", text));
  return {index % count, count};
}

std::int64_t ShardOf(std::int64_t linear_index, std::int64_t count) {
  return (linear_index % count + FirstShardOf(linear_index / count, count)) % count;
}

bool InShard(std::int64_t linear_index, const Shard& shard) {
  return ShardOf(linear_index, shard.count) == shard.index;
}

std::vector<sweep::RunId> Todo(const store::RunLayout& layout, int stage, const Shard& shard,
                               const std::vector<sweep::RunId>& stored) {
  std::vector<sweep::RunId> todo;
  const store::RunLayout::Stage& shape = layout.stages[stage];
  for (int arm = 0; arm < static_cast<int>(shape.arms.size()); ++arm) {
    for (int mission = 0; mission < shape.missions; ++mission) {
      const sweep::RunId id{stage, arm, mission};
      if (InShard(layout.LinearIndex(id), shard) && !std::binary_search(stored.begin(), stored.end(), id))
        todo.push_back(id);
    }
  }
  return todo;
}

std::vector<sweep::RunId> Arrange(std::vector<sweep::RunId> todo, Order order, std::uint64_t seed) {
  if (order == Order::kReversed) std::reverse(todo.begin(), todo.end());
  if (order == Order::kShuffled) {
    Stream stream(seed, 0, Purpose::kScenario);
    for (std::size_t left = todo.size(); left > 1; --left)  // Fisher-Yates
      std::swap(todo[left - 1], todo[stream.Below(static_cast<std::uint32_t>(left))]);
  }
  return todo;
}

}  // namespace ed3r::schedule
