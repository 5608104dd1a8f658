#include "studies/flight_logs/time_series.h"

#include <gtest/gtest.h>

#include <cmath>

namespace ed3r::flight_logs {
namespace {

TEST(TimeSeriesTest, NearestAndLast) {
  TimeSeries series;
  EXPECT_TRUE(std::isnan(series.Nearest(0.0)));
  for (const auto& [time_s, value] :
       {std::pair{1.0, 10.0}, {2.0, 20.0}, {2.0, 99.0}, {1.5, 15.0}, {4.0, 40.0}})
    series.Add(time_s, value);
  EXPECT_EQ(series.size(), 4u) << "of two with one stamp the first counts";
  EXPECT_DOUBLE_EQ(series.Nearest(1.2), 10.0);
  EXPECT_DOUBLE_EQ(series.Nearest(1.4), 15.0) << "it came late, and belongs where its stamp says";
  EXPECT_DOUBLE_EQ(series.back_s(), 0.5);
  EXPECT_DOUBLE_EQ(series.back_from_s(), 2.0);
  EXPECT_DOUBLE_EQ(series.Nearest(1.8), 20.0);
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
