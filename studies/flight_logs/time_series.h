// Values of one source over time, and how sources of different rates come onto one clock.
//
// A value is taken from the sample nearest in time, and from none that is further than kMaxJoinS away: neither
// interpolation, which would smooth one source and not another, nor the previous value, which lags by up to a sample.
// Flags keep the previous value: a state holds until it changes.
#pragma once

#include <cstddef>
#include <vector>

namespace ed3r::flight_logs {

inline constexpr double kMaxJoinS = 1.0;

class TimeSeries {
 public:
  // A sample belongs where its stamp says, by up to kMaxJoinS before the latest; of two with one stamp the first counts.
  void Add(double time_s, double value);

  // The farthest that a stamp lies before the latest one that stands ahead of it in the file, and that one; 0 where none does.
  double back_s() const { return back_s_; }
  double back_from_s() const { return back_from_s_; }

  bool empty() const { return times_s_.empty(); }
  std::size_t size() const { return times_s_.size(); }
  double time_s(std::size_t i) const { return times_s_[i]; }
  double value(std::size_t i) const { return values_[i]; }

  // The earlier of two that are as near; NaN where no sample is within kMaxJoinS.
  double Nearest(double time_s) const;
  // The last sample up to that time; `before_first` where there is none.
  double Last(double time_s, double before_first) const;

 private:
  std::vector<double> times_s_, values_;
  double back_s_ = 0.0, back_from_s_ = 0.0;
};

}  // namespace ed3r::flight_logs
