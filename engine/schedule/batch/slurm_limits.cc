#include "engine/schedule/batch/slurm_limits.h"

#include <algorithm>
#include <charconv>
#include <system_error>
#include <vector>

namespace ed3r::schedule {
namespace {

constexpr std::size_t kMostDigits = 9;

std::optional<std::int64_t> Number(std::string_view digits) {
  std::int64_t value = 0;
  if (digits.empty() || digits.size() > kMostDigits) return std::nullopt;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc() || end != digits.data() + digits.size() || value < 0) return std::nullopt;
  return value;
}

// The numbers between colons; empty where one is none.
std::vector<std::int64_t> Numbers(std::string_view text) {
  std::vector<std::int64_t> numbers;
  for (bool more = true; more;) {
    const std::size_t colon = text.find(':');
    more = colon != std::string_view::npos;
    const auto number = Number(text.substr(0, colon));
    if (!number) return {};
    numbers.push_back(*number);
    if (more) text.remove_prefix(colon + 1);
  }
  return numbers;
}

}  // namespace

std::optional<std::int64_t> SlurmTime_s(std::string_view text) {
  constexpr std::int64_t kMinute_s = 60, kHour_s = 3600, kDay_s = 86400;
  const std::size_t dash = text.find('-');
  const bool with_days = dash != std::string_view::npos;
  const std::vector<std::int64_t> numbers = Numbers(with_days ? text.substr(dash + 1) : text);
  if (numbers.empty() || numbers.size() > 3) return std::nullopt;
  if (with_days) {
    const auto days = Number(text.substr(0, dash));
    if (!days) return std::nullopt;
    constexpr std::int64_t kUnits_s[] = {kHour_s, kMinute_s, 1};
    std::int64_t time_s = *days * kDay_s;
    for (std::size_t i = 0; i < numbers.size(); ++i) time_s += numbers[i] * kUnits_s[i];
    return time_s;
  }
  switch (numbers.size()) {
    case 1:
      return numbers[0] * kMinute_s;
    case 2:
      return numbers[0] * kMinute_s + numbers[1];
    default:
      return numbers[0] * kHour_s + numbers[1] * kMinute_s + numbers[2];
  }
}

bool IsSlurmMemory(std::string_view text) {
  if (!text.empty() && std::string_view("KMGT").find(text.back()) != std::string_view::npos)
    text.remove_suffix(1);
  return Number(text).value_or(0) > 0;
}

}  // namespace ed3r::schedule
