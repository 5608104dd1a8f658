// Which missions a process flies, and in which order. Neither changes a result: a mission depends on its
// number alone.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "engine/store/layout.h"

namespace ed3r::schedule {

// Part `index` of `count`. Missions are dealt in plan order, one to each part, so that each gets its share of every
// arm; a deal begins with another part each time, because sites recur at a fixed distance and far ones take longer.
struct Shard {
  std::int64_t index = 0;
  std::int64_t count = 1;
};

// "I/N" with 0 <= I <= N. Both ways of counting shards work, from 0 and from 1, because N/N is the same shard
// as 0/N. UserError for anything else.
Shard ParseShard(std::string_view text);

// The number of the shard, below `count`, that a mission belongs to.
std::int64_t ShardOf(std::int64_t linear_index, std::int64_t count);

bool InShard(std::int64_t linear_index, const Shard& shard);

// Missions of one stage that belong to the shard and are not in `stored` (sorted), in plan order.
std::vector<sweep::RunId> Todo(const store::RunLayout& layout, int stage, const Shard& shard,
                               const std::vector<sweep::RunId>& stored);

enum class Order { kNatural, kReversed, kShuffled };

// For tests, which show that the order does not matter; a shuffle is a function of the seed.
std::vector<sweep::RunId> Arrange(std::vector<sweep::RunId> todo, Order order, std::uint64_t seed = 0);

}  // namespace ed3r::schedule
