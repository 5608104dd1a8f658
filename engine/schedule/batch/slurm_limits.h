// Limits of a job as sbatch documents them (man sbatch, --time and --mem).
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace ed3r::schedule {

// Seconds of "minutes", "minutes:seconds", "hours:minutes:seconds", "days-hours", "days-hours:minutes" or
// "days-hours:minutes:seconds"; none of anything else.
std::optional<std::int64_t> SlurmTime_s(std::string_view text);

// A number and then K, M, G, T or nothing (megabytes). Not 0, which asks for all memory of a node.
bool IsSlurmMemory(std::string_view text);

}  // namespace ed3r::schedule
