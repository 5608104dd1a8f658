#include "studies/flight_logs/skipped_bytes.h"

#include <fmt/format.h>

#include <algorithm>

#include "engine/core/check.h"
#include "engine/core/message.h"
#include "studies/flight_logs/log_table.h"

namespace ed3r::flight_logs {
namespace {

// Bytes before the zeros, or the 0xFF, that a file ends with.
std::size_t WrittenBytes(std::string_view file) {
  const std::size_t zeros = file.find_last_not_of('\0') + 1, ones = file.find_last_not_of('\xFF') + 1;
  return std::min(zeros, ones);
}

}  // namespace

SkippedBytes::SkippedBytes(const std::string& path, std::string_view file)
    : path_(path), written_(WrittenBytes(file)) {}

void SkippedBytes::Add(std::size_t from, std::size_t to, const std::string& problem) {
  if (places_++ == 0) first_ = from;
  skipped_ += std::min(to, written_) - std::min(from, written_);
  if (static_cast<double>(skipped_) > kMaxBadShare * static_cast<double>(written_))
    throw UserError(
        OneLine(fmt::format("{}; --skip-bad would leave out {} of {} bytes, at most {:g} % are allowed",
                            problem, skipped_, written_, 100.0 * kMaxBadShare)));
}

std::string SkippedBytes::Note() const {
  return OneLine(fmt::format("{}: {} of {} bytes could not be read, the first is byte {}", path_, skipped_,
                             written_, first_));
}

}  // namespace ed3r::flight_logs
