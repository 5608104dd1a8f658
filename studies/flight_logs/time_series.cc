#include "studies/flight_logs/time_series.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ed3r::flight_logs {
namespace {

constexpr double kStampS = 1e-6;  // stamps are whole microseconds; closer is the same

}  // namespace

void TimeSeries::Add(double time_s, double value) {
  if (!std::isfinite(time_s)) return;
  if (!times_s_.empty() && times_s_.back() - time_s > back_s_) {
    back_s_ = times_s_.back() - time_s;
    back_from_s_ = times_s_.back();
  }
  // What lies further back makes the log one that is refused, or the sample one of a state that is known already.
  if (!times_s_.empty() && times_s_.back() - time_s > kMaxJoinS) return;
  const auto after = std::lower_bound(times_s_.begin(), times_s_.end(), time_s);
  if (after != times_s_.end() && *after == time_s) return;
  values_.insert(values_.begin() + (after - times_s_.begin()), value);
  times_s_.insert(after, time_s);
}

double TimeSeries::Nearest(double time_s) const {
  const auto after = std::lower_bound(times_s_.begin(), times_s_.end(), time_s);
  auto best = after;
  if (after == times_s_.end() ||
      (after != times_s_.begin() && time_s - *(after - 1) <= *after - time_s + kStampS))
    best = after == times_s_.begin() ? after : after - 1;
  if (best == times_s_.end() || std::abs(*best - time_s) > kMaxJoinS)
    return std::numeric_limits<double>::quiet_NaN();
  return values_[static_cast<std::size_t>(best - times_s_.begin())];
}

double TimeSeries::Last(double time_s, double before_first) const {
  const auto after = std::upper_bound(times_s_.begin(), times_s_.end(), time_s);
  return after == times_s_.begin() ? before_first
                                   : values_[static_cast<std::size_t>(after - times_s_.begin()) - 1];
}

}  // namespace ed3r::flight_logs
