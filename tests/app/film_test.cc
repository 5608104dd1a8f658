// `ed3r replay --video`: a film that can be played, and refusals before anything is flown.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>
#include <vector>

#include "tests/app/command.h"

namespace ed3r::app {
namespace {

namespace fs = std::filesystem;

// A mission that a small battery ends soon.
class FilmTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    scratch_ = new ScratchFolder;
    const CommandResult flown =
        Ed3r(fmt::format("run {}/sweeps/rbs.yaml --set robot.battery_mah=150 --missions 1 --quiet --out {}",
                         ED3R_SOURCE_DIR, Run()));
    ASSERT_EQ(flown.status, 0) << flown.err;
  }
  static void TearDownTestSuite() { delete scratch_; }
  static std::string Run() { return (*scratch_ / "run").string(); }
  CommandResult Film(const fs::path& film) {
    return Ed3r(
        fmt::format("replay {} rbs/0 --out {} --video {}", Run(), (out_ / "replay").string(), film.string()));
  }

  static ScratchFolder* scratch_;
  ScratchFolder out_;
};
ScratchFolder* FilmTest::scratch_ = nullptr;

TEST_F(FilmTest, AFilmPlaysFromTheBeginToTheEndOfTheMission) {
  const fs::path film = out_ / "mission.mp4";
  const CommandResult result = Film(film);
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find("4 times as fast"), std::string::npos) << result.out;

  cv::VideoCapture reader(film.string(), cv::CAP_FFMPEG);
  ASSERT_TRUE(reader.isOpened());
  std::vector<cv::Mat> frames;
  for (cv::Mat frame; reader.read(frame);) frames.push_back(frame.clone());
  const std::size_t at = result.out.find(" timesteps, ");
  ASSERT_NE(at, std::string::npos) << result.out;
  const double duration_s = std::stod(result.out.substr(at + 12));
  // 3 a second of the mission, and 24 of its end; the mission's length was printed with one digit.
  EXPECT_NEAR(static_cast<double>(frames.size()), 3.0 * duration_s + 24.5, 1.0);
  ASSERT_GT(frames.size(), 30u);
  EXPECT_EQ(frames.front().size(), cv::Size(1280, 600));
  cv::Scalar mean, deviation;
  cv::meanStdDev(frames.front()(cv::Rect(0, 40, 800, 380)), mean, deviation);
  EXPECT_GT(deviation[1], 5.0) << "the camera sees something";
  // The robot has moved on the map.
  const cv::Rect map(800, 0, 480, 450);
  EXPECT_GT(cv::norm(frames.front()(map), frames.back()(map), cv::NORM_INF), 60.0);
}

TEST_F(FilmTest, WhatCannotBeWrittenIsRefusedInOneLineBeforeAnythingFlies) {
  fs::create_directory(out_ / "folder.mp4");
  for (const auto& [film, told] : std::vector<std::pair<fs::path, std::string>>{
           {out_ / "film.avi", "must end in .mp4"},
           {out_ / "nowhere" / "film.mp4", "No such file or directory"},
           {out_ / "folder.mp4", "something other than a file"}}) {
    const CommandResult result = Film(film);
    EXPECT_EQ(result.status, 2) << film;
    EXPECT_NE(result.err.find(told), std::string::npos) << result.err;
    EXPECT_NE(result.err.find("--video " + film.string()), std::string::npos) << result.err;
    EXPECT_EQ(result.err.find('\n'), result.err.size() - 1) << result.err;
    EXPECT_FALSE(fs::exists(out_ / "replay"));
  }
  for (const auto& entry : fs::directory_iterator(out_.Path()))
    EXPECT_EQ(entry.path().filename(), "folder.mp4") << "nothing is left";
}

TEST_F(FilmTest, NothingIsLeftOfAFilmThatWasEnded) {
  const std::string replay = fmt::format("replay {} rbs/0 --out {} --video {}", Run(),
                                         (out_ / "replay").string(), (out_ / "f.mp4").string());
  const fs::path files = out_ / "tmp";
  fs::create_directory(files);
  // Ended as soon as it writes the film; "signal" is its own.
  const auto end = [&](const std::string& signal) {
    const std::string line = fmt::format("TMPDIR={1} " ED3R_BINARY
                                         " {0} 2>/dev/null & child=$!; "
                                         "for i in $(seq 600); do ls {2}/.*.mp4 >/dev/null 2>&1 && break; "
                                         "sleep 0.05; done; kill -{3} $child; wait $child",
                                         replay, files.string(), out_.Path().string(), signal);
    ASSERT_NE(std::system(fmt::format("bash -c '{}'", line).c_str()), 0);
  };
  const auto films = [&] {
    return std::count_if(fs::directory_iterator(out_.Path()), fs::directory_iterator(),
                         [](const fs::directory_entry& entry) { return entry.path().extension() == ".mp4"; });
  };
  for (const char* signal : {"INT", "TERM"}) {
    end(signal);
    EXPECT_EQ(films(), 0) << signal;
    EXPECT_TRUE(fs::is_empty(files)) << signal;
  }
  end("KILL");
  EXPECT_EQ(films(), 1) << "it cannot know";
  EXPECT_EQ(Ed3r(replay).status, 0);
  EXPECT_EQ(films(), 1) << "the film alone";
  EXPECT_TRUE(fs::exists(out_ / "f.mp4"));
}

}  // namespace
}  // namespace ed3r::app
