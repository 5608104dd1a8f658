#include "studies/fit/repeated_flights.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "tests/flight_logs/complaint.h"

namespace ed3r::fit {
namespace {

// A course of 300 rows at 0.2 s; a test changes its rows.
FlightLog Course(const std::string& file, const std::function<void(FlightRow&)>& change = {}) {
  FlightLog log;
  log.files = {file};
  Flight flight{.id = file, .rows = {}, .table = 0};
  for (std::size_t i = 0; i < 300; ++i) {
    FlightRow row;
    row.source_row = i;
    row.time_s = 81.17 + 0.2 * static_cast<double>(i);
    row.airspeed_mps = i / 50 % 2 == 0 ? 0.0 : 5.0;
    row.power_w = 300.0 + std::round(60.0 * std::sin(1.7 * static_cast<double>(i)));
    if (change) change(row);
    flight.rows.push_back(row);
  }
  log.flights.push_back(flight);
  return log;
}

std::string Says(const std::function<void(FlightRow&)>& change) {
  const FlightLog fitted = Course("a.csv"), evaluated = Course("b.csv", change);
  return flight_logs::Complaint([&] { CheckNoFlightTwice(fitted, &evaluated); });
}

double Rounded(double value, double unit) { return unit * std::round(value / unit); }

const std::string kSeen =
    "--evaluate b.csv: flight 'b.csv' has the rows of flight 'a.csv' of a.csv: only flights that the fit has "
    "not seen judge it; leave one of them out";

// Such copies were "never seen by the fit".
TEST(RepeatedFlightsTest, ACopyWithAnotherClockIsTheSameFlight) {
  EXPECT_EQ(Says({}), kSeen);
  EXPECT_EQ(Says([](FlightRow& row) { row.time_s -= 81.17; }), kSeen);
  for (const double unit_s : {0.01, 0.05, 0.1})
    for (const double first_s : {81.17, 0.0})
      EXPECT_EQ(Says([&](FlightRow& row) { row.time_s = Rounded(row.time_s - 81.17, unit_s) + first_s; }),
                kSeen)
          << unit_s;
  EXPECT_EQ(Says([](FlightRow& row) { row.time_s = Rounded(row.time_s, 0.1); }), kSeen);
}

// Was judged as "never seen": its clock begins elsewhere, and so does its first row.
TEST(RepeatedFlightsTest, ACopyThatIsCutAtItsStartIsTheSameFlight) {
  const auto cut = [](std::size_t first, std::size_t step, const std::function<void(FlightRow&)>& change) {
    FlightLog log = Course("b.csv", change);
    std::vector<FlightRow> left;
    for (std::size_t i = first; i < log.flights[0].rows.size(); i += step)
      left.push_back(log.flights[0].rows[i]);
    log.flights[0].rows = left;
    const FlightLog fitted = Course("a.csv");
    return flight_logs::Complaint([&] { CheckNoFlightTwice(fitted, &log); });
  };
  for (const std::size_t first : {1, 37, 140})
    for (const double shift_s : {-81.17, 12.345, 1.7e9})
      EXPECT_EQ(cut(first, 1, [&](FlightRow& row) { row.time_s += shift_s; }), kSeen)
          << first << " " << shift_s;
  EXPECT_EQ(cut(40, 1, [](FlightRow& row) { row.time_s = Rounded(row.time_s - 89.17, 0.1); }), kSeen);
  EXPECT_EQ(cut(41, 2, [](FlightRow& row) { row.time_s -= 89.37; }), kSeen);  // every second row
}

// Its power, in whole watts, is that of the other now and then.
TEST(RepeatedFlightsTest, TheSameCourseFlownAgainIsAnotherFlight) {
  for (const double first_s : {81.17, 0.0})
    EXPECT_EQ(Says([&](FlightRow& row) {
                row.time_s += first_s - 81.17;
                row.power_w = 300.0 + std::round(60.0 * std::sin(2.9 * static_cast<double>(row.source_row)));
              }),
              "");
}

}  // namespace
}  // namespace ed3r::fit
