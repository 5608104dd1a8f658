#include "studies/flight_logs/time_series.h"

#include <gtest/gtest.h>

#include <cmath>

namespace ed3r::flight_logs {
namespace {

TEST(TimeSeriesTest, NearestAndLast) {
  TimeSeries series;
  EXPECT_TRUE(std::isnan(series.Nearest(0.0)));
  for (const auto& [time_s, value] :
       {std::pair{1.0, 10.0}, {2.0, 20.0}, {2.0, 99.0}, {1.5, 99.0}, {4.0, 40.0}})
    series.Add(time_s, value);
  EXPECT_EQ(series.size(), 3u) << "stamps that do not increase are passed over";
  EXPECT_DOUBLE_EQ(series.Nearest(1.4), 10.0);
  EXPECT_DOUBLE_EQ(series.Nearest(1.6), 20.0);
  EXPECT_DOUBLE_EQ(series.Nearest(0.1), 10.0);
  EXPECT_DOUBLE_EQ(series.Nearest(4.9), 40.0);
  EXPECT_DOUBLE_EQ(series.Nearest(3.0), 20.0) << "a second away is near, and the earlier of two";
  EXPECT_TRUE(std::isnan(series.Nearest(5.1)));
  EXPECT_DOUBLE_EQ(series.Last(0.5, -1.0), -1.0);
  EXPECT_DOUBLE_EQ(series.Last(2.0, -1.0), 20.0);
  EXPECT_DOUBLE_EQ(series.Last(100.0, -1.0), 40.0);
}

}  // namespace
}  // namespace ed3r::flight_logs
