// Detectors and pictures that people bring, as they meet the program.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/app/command.h"
#include "tests/vision/onnx_writer.h"

namespace ed3r::app {
namespace {

namespace fs = std::filesystem;

const std::string kPicture = ED3R_SOURCE_DIR "/tests/fuzz/corpus/picture/small.png";

class OwnDetectorCommand : public testing::Test {
 protected:
  void Write(const std::string& name, const std::string& bytes) const {
    std::ofstream(scratch_ / name, std::ios::binary) << bytes;
  }

  // Fine on blank frames; where red and blue differ in the mean, the root of a negative number.
  std::string NoNumber() const {
    test::OnnxWriter model;
    model.Input("frame", {1, 3, 54, 96}).Output("y", {1, 1});
    model.Weights("w", {3, 1}, {1000, 0, -1000}).Weights("c", {1}, {0.0001F});
    model.Step("GlobalAveragePool", {"frame"}, {"means"})
        .Step("Flatten", {"means"}, {"flat"}, {{"axis", std::int64_t{1}}})
        .Step("Gemm", {"flat", "w"}, {"d"})
        .Step("Mul", {"d", "d"}, {"square"})
        .Step("Sub", {"c", "square"}, {"left"})
        .Step("Sqrt", {"left"}, {"y"});
    const std::string name = "no_number.onnx";
    Write(name, model.Bytes());
    return (scratch_ / name).string();
  }

  ScratchFolder scratch_;
};

TEST_F(OwnDetectorCommand, OneBadPictureIsReportedAndTheOthersAreScored) {
  fs::create_directories(scratch_ / "pictures");
  fs::copy_file(kPicture, scratch_ / "pictures" / "good.png");
  const std::string bytes = ReadAll(kPicture);
  Write("pictures/cut.png", bytes.substr(0, bytes.size() / 2));
  Write("pictures/notes.txt", "of no concern");
  const std::string folder = (scratch_ / "pictures").string();
  const CommandResult text = Ed3r("detect " + folder);
  EXPECT_EQ(text.status, 3) << text.err;
  EXPECT_NE(text.out.find("\ngood.png  "), std::string::npos) << text.out;
  EXPECT_EQ(text.out.find("cut.png"), std::string::npos) << text.out;
  for (const char* said : {"cut.png: is cut short\n", "note: 1 file of other kinds passed over\n",
                           "1 picture without a score, 1 scored\n",
                           "note: both networks are built in and learnt from rendered frames"})
    EXPECT_NE(text.err.find(said), std::string::npos) << said << text.err;
  const CommandResult printed = Ed3r("detect --json " + folder);
  EXPECT_EQ(printed.status, 3);
  const auto json = nlohmann::json::parse(printed.out);
  EXPECT_TRUE(json["good.png"]["full"].is_number());
  EXPECT_EQ(json["cut.png"]["error"], folder + "/cut.png: is cut short");

  fs::remove(scratch_ / "pictures" / "good.png");
  EXPECT_EQ(Ed3r("detect " + folder).status, 2) << "none could be scored";
}

TEST_F(OwnDetectorCommand, WhatIsNoNumberIsNeverPrinted) {
  fs::create_directories(scratch_ / "pictures");
  fs::copy_file(kPicture, scratch_ / "pictures" / "good.png");
  const CommandResult folder = Ed3r(fmt::format("detect {} --json --set perception.detector.full={}",
                                                (scratch_ / "pictures").string(), NoNumber()));
  EXPECT_EQ(folder.status, 2);
  EXPECT_EQ(folder.out.find("null"), std::string::npos) << folder.out;
  EXPECT_NE(folder.out.find("no_number.onnx: answers not a number"), std::string::npos) << folder.out;
  const CommandResult one =
      Ed3r(fmt::format("detect {} --set perception.detector.full={}", kPicture, NoNumber()));
  EXPECT_EQ(one.status, 2);
  EXPECT_EQ(one.out, "");
  EXPECT_NE(one.err.find("no_number.onnx: answers not a number"), std::string::npos) << one.err;
}

TEST_F(OwnDetectorCommand, AMissionWhoseDetectorAnswersNoNumberHasFailed) {
  const std::string run = (scratch_ / "run").string();
  const CommandResult flown =
      Ed3r(fmt::format("run {}/sweeps/rbs.yaml --quiet --missions 2 --set perception.tier=pixels --set "
                       "perception.detector.full={} "
                       "--set perception.detector.quantized={} --out {}",
                       ED3R_SOURCE_DIR, NoNumber(), NoNumber(), run));
  EXPECT_EQ(flown.status, 3) << flown.err;
  const auto json = nlohmann::json::parse(Ed3r("status --json " + run).out);
  EXPECT_EQ(json["failure_kinds"]["detector-answer"], 2) << json.dump();
  EXPECT_NE(json.dump().find("no_number.onnx: answers not a number, which is no probability"),
            std::string::npos)
      << json.dump();
}

}  // namespace
}  // namespace ed3r::app
