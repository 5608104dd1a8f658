// `ed3r detect` on a data set of `ed3r frames`.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/app/command.h"

namespace ed3r::app {
namespace {

class DetectCommand : public testing::Test {
 protected:
  std::string Frames(int views) {
    const std::string out = (scratch_ / fmt::format("{}", views)).string();
    const CommandResult result =
        Ed3r(fmt::format("frames --out {} --world " ED3R_SOURCE_DIR
                         "/sweeps/worlds/training_b.yaml --views {} --frames 1 --seed 5 --pictures 0",
                         out, views));
    EXPECT_EQ(result.status, 0) << result.err;
    return out;
  }
  std::string Detect(const std::string& arguments) {
    const CommandResult result = Ed3r("detect " + arguments);
    EXPECT_EQ(result.status, 0) << result.err;
    return result.out;
  }

  ScratchFolder scratch_;
};

TEST_F(DetectCommand, SaysWhetherQuantizedIsWorseThanFull) {
  const std::string set = Frames(80);
  const std::string text = Detect(set);
  EXPECT_NE(text.find("\nQuantized minus Full, same frames (95 %"), std::string::npos) << text;
  EXPECT_NE(text.find(" of 80 views"), std::string::npos) << text;

  const std::string printed = Detect(set + " --json");
  EXPECT_EQ(Detect(set + " --json"), printed);
  const auto json = nlohmann::json::parse(printed);
  const auto& difference = json["difference"];
  const auto& all = json["all"]["all"];
  for (const char* score : {"auc", "accuracy"})
    EXPECT_NEAR(difference[score]["mean"].get<double>(),
                all["quantized"][score].get<double>() - all["full"][score].get<double>(), 1e-12)
        << score;
  for (const char* score : {"auc", "accuracy", "cross_entropy"}) {
    EXPECT_LE(difference[score]["lo"].get<double>(), difference[score]["mean"].get<double>()) << score;
    EXPECT_GE(difference[score]["hi"].get<double>(), difference[score]["mean"].get<double>()) << score;
  }
  EXPECT_EQ(difference["views"], 80);
  EXPECT_EQ(all["difference"], difference);
  EXPECT_TRUE(json["world"]["training b"]["difference"]["auc"].contains("lo"));
}

TEST_F(DetectCommand, TheTableHoldsEachFrameAndAgreesWithTheScores) {
  const std::string set = Frames(12);
  const std::filesystem::path table = scratch_ / "table.csv";
  const auto json = nlohmann::json::parse(Detect(set + " --json --table " + table.string()));
  std::istringstream lines(ReadAll(table));
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "index,full,quantized");
  int frames = 0, full = 0, quantized = 0;
  while (std::getline(lines, line)) {
    int index = -1;
    double f = -1.0, q = -1.0;
    ASSERT_EQ(std::sscanf(line.c_str(), "%d,%lf,%lf", &index, &f, &q), 3) << line;
    EXPECT_EQ(index, frames++);
    full += f >= 0.5;
    quantized += q >= 0.5;
  }
  EXPECT_EQ(frames, 12);
  const auto said = [&](const char* model) {
    const auto& scores = json["all"]["all"][model];
    return scores["true_positives"].get<int>() + scores["false_positives"].get<int>();
  };
  EXPECT_EQ(full, said("full"));
  EXPECT_EQ(quantized, said("quantized"));
  const CommandResult picture = Ed3r("detect " ED3R_SOURCE_DIR "/results/perception/view.png --table x.csv");
  EXPECT_EQ(picture.status, 2);
  EXPECT_NE(picture.err.find("--table"), std::string::npos) << picture.err;
}

TEST_F(DetectCommand, FewViewsAreSaidToBeTooFew) {
  const std::string set = Frames(12);
  const std::string text = Detect(set);
  EXPECT_NE(text.find("too few views for an interval"), std::string::npos) << text;
  EXPECT_EQ(text.find("distinguishable"), std::string::npos) << text;
  const auto json = nlohmann::json::parse(Detect(set + " --json"));
  EXPECT_TRUE(json["difference"]["accuracy"]["lo"].is_null());
  EXPECT_TRUE(json["difference"]["accuracy"]["mean"].is_number());
}

}  // namespace
}  // namespace ed3r::app
