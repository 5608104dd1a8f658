#include "engine/core/progress.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cmath>

namespace ed3r {
namespace {

constexpr auto kShortestPause = std::chrono::milliseconds(200);

// Three digits that matter: 0.42, 38.1, 5120.
std::string Compact(double value) {
  return fmt::format("{:.{}f}", value, value < 10 ? 2 : value < 100 ? 1 : 0);
}

std::string Clock(double seconds) {
  const auto s = static_cast<std::int64_t>(std::ceil(seconds));
  if (s < 3600) return fmt::format("{}:{:02}", s / 60, s % 60);
  return fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
}

// Columns of the terminal; a wrapped line could not be written over.
std::size_t Width(std::FILE* out) {
  winsize size = {};
  return ioctl(fileno(out), TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

}  // namespace

std::string ProgressText(const ProgressState& s) {
  const std::int64_t done = s.stored_before + s.stored;
  const double percent =
      s.total > 0 ? std::floor(100.0 * static_cast<double>(done) / static_cast<double>(s.total)) : 100;
  const std::int64_t ended = s.stored + s.failed;
  const double rate = s.elapsed_s > 0 ? static_cast<double>(ended) / s.elapsed_s : 0;
  const double real_time = s.elapsed_s > 0 ? s.simulated_s / s.elapsed_s : 0;
  const std::string eta =
      rate > 0 ? Clock(static_cast<double>(s.total - s.stored_before - ended) / rate) : "-";
  return fmt::format("{}  {}/{}  {:.0f} %  {} missions/s  {}x real time  eta {}  failed {}", s.label, done,
                     s.total, percent, Compact(rate), Compact(real_time), eta, s.failed);
}

ProgressLine::ProgressLine(std::FILE* out, bool quiet)
    : out_(out), enabled_(!quiet && out != nullptr && isatty(fileno(out)) == 1) {}

ProgressLine::~ProgressLine() { Clear(); }

void ProgressLine::Show(const ProgressState& state) { Show(ProgressText(state)); }

void ProgressLine::Show(const std::string& text) {
  if (!enabled_) return;
  const auto now = std::chrono::steady_clock::now();
  if (last_ && now - *last_ < kShortestPause) return;
  last_ = now;
  const std::string line = text.substr(0, Width(out_) - 1);
  std::fprintf(out_, "\r%s\033[K", line.c_str());
  std::fflush(out_);
  visible_ = true;
}

void ProgressLine::Clear() {
  if (!visible_) return;
  std::fprintf(out_, "\r\033[K");
  std::fflush(out_);
  visible_ = false;
}

}  // namespace ed3r
