// The progress line of a sweep, e.g.
//   rbs  412/850  48 %  38.1 missions/s  5120x real time  eta 0:11  failed 0
#pragma once

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <string>

namespace ed3r {

struct ProgressState {
  std::string label = {};          // what is being flown
  std::int64_t total = 0;          // missions, those stored before included
  std::int64_t stored_before = 0;  // by earlier sessions: they count as done, not for the rate
  std::int64_t stored = 0;         // by this session
  std::int64_t failed = 0;         // in this session
  double elapsed_s = 0;            // wall time of this session
  double simulated_s = 0;          // flown by the stored missions of this session
};

// The line without line end. The rate is the mean of this session; "eta -" before the first mission.
std::string ProgressText(const ProgressState& state);

// Writes the line over itself, at most five times a second. Shows nothing when `out` is not a terminal or
// `quiet` is set, and leaves nothing behind. Threads: one at a time.
class ProgressLine {
 public:
  ProgressLine(std::FILE* out, bool quiet);
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  void Show(const ProgressState& state);
  void Show(const std::string& text);
  void Clear();

 private:
  std::FILE* out_;
  bool enabled_;
  bool visible_ = false;
  std::optional<std::chrono::steady_clock::time_point> last_;
};

}  // namespace ed3r
