#include "engine/core/progress.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdlib>
#include <thread>

namespace ed3r {
namespace {

ProgressState Example() {
  return {.label = "rbs",
          .total = 850,
          .stored_before = 31,
          .stored = 381,
          .failed = 0,
          .elapsed_s = 10.0,
          .simulated_s = 51200.0};
}

TEST(ProgressTextTest, SaysRateRemainingTimeAndFailures) {
  EXPECT_EQ(ProgressText(Example()),
            "rbs  412/850  48 %  38.1 missions/s  5120x real time  eta 0:12  failed 0");
  ProgressState failing = Example();
  failing.failed = 19;  // they were flown as well: they count for the rate, not as done
  EXPECT_EQ(ProgressText(failing),
            "rbs  412/850  48 %  40.0 missions/s  5120x real time  eta 0:11  failed 19");
}

TEST(ProgressTextTest, BeforeTheFirstMissionAndAtTheEnd) {
  EXPECT_EQ(ProgressText({.label = "s", .total = 10, .elapsed_s = 1}),
            "s  0/10  0 %  0.00 missions/s  0.00x real time  eta -  failed 0");
  EXPECT_EQ(ProgressText({.label = "s", .total = 10, .stored = 10, .elapsed_s = 100, .simulated_s = 250}),
            "s  10/10  100 %  0.10 missions/s  2.50x real time  eta 0:00  failed 0");
  EXPECT_EQ(ProgressText({}), "  0/0  100 %  0.00 missions/s  0.00x real time  eta -  failed 0");
}

TEST(ProgressTextTest, LongTimesHaveHours) {
  const ProgressState slow = {.label = "s", .total = 1000, .stored = 1, .elapsed_s = 100};
  EXPECT_NE(ProgressText(slow).find("eta 27:45:00"), std::string::npos) << ProgressText(slow);
}

// A container without /dev/pts cannot make terminals.
class ProgressLineTest : public testing::Test {
 protected:
  void SetUp() override {
    const int outside = posix_openpt(O_RDWR | O_NOCTTY);
    const bool usable = outside >= 0 && grantpt(outside) == 0 && unlockpt(outside) == 0 &&
                        access(ptsname(outside), W_OK) == 0;
    if (outside >= 0) close(outside);
    if (!usable) GTEST_SKIP() << "no pseudo-terminal on this machine";
  }
};

// A terminal of our own to look at from the other side.
class Terminal {
 public:
  explicit Terminal(unsigned short columns) {
    outside_ = posix_openpt(O_RDWR | O_NOCTTY);
    grantpt(outside_);
    unlockpt(outside_);
    const int inside = open(ptsname(outside_), O_RDWR | O_NOCTTY);
    winsize size = {};
    size.ws_col = columns;
    ioctl(inside, TIOCSWINSZ, &size);
    inside_ = fdopen(inside, "w");
    fcntl(outside_, F_SETFL, O_NONBLOCK);
  }
  ~Terminal() {
    std::fclose(inside_);
    close(outside_);
  }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  std::FILE* inside() { return inside_; }
  std::string Output() {
    std::string text;
    char buffer[4096];
    for (ssize_t n; (n = read(outside_, buffer, sizeof buffer)) > 0;)
      text.append(buffer, static_cast<std::size_t>(n));
    return text;
  }

 private:
  int outside_;
  std::FILE* inside_;
};

TEST_F(ProgressLineTest, WritesOverItselfAtMostFiveTimesASecondAndClears) {
  Terminal terminal(120);
  const auto begin = std::chrono::steady_clock::now();
  {
    ProgressLine line(terminal.inside(), false);
    for (int i = 0; i < 50; ++i) {
      line.Show(Example());
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin;
  const std::string output = terminal.Output();
  const std::string shown = fmt::format("\r{}\033[K", ProgressText(Example()));
  const std::string cleared = "\r\033[K";
  int times = 0;
  std::size_t at = 0;
  for (; output.compare(at, shown.size(), shown) == 0; at += shown.size()) ++times;
  EXPECT_GE(times, 2);
  EXPECT_LE(times, elapsed.count() * 5 + 1);
  EXPECT_EQ(output.substr(at), cleared);
}

TEST_F(ProgressLineTest, FitsIntoTheTerminal) {
  Terminal terminal(20);
  ProgressLine line(terminal.inside(), false);
  line.Show(Example());
  EXPECT_EQ(terminal.Output(), fmt::format("\r{}\033[K", ProgressText(Example()).substr(0, 19)));
}

TEST_F(ProgressLineTest, IsSilentWhenQuietOrNotATerminal) {
  Terminal terminal(80);
  {
    ProgressLine line(terminal.inside(), true);
    line.Show(Example());
  }
  EXPECT_EQ(terminal.Output(), "");
  std::FILE* file = std::tmpfile();
  ASSERT_NE(file, nullptr);
  {
    ProgressLine line(file, false);
    line.Show(Example());
  }
  EXPECT_EQ(std::ftell(file), 0);
  std::fclose(file);
}

}  // namespace
}  // namespace ed3r
