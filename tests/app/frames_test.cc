// `ed3r frames`: what it writes can be read back, and bad input is one line and nothing written.
#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "engine/core/sha256.h"
#include "tests/app/command.h"

namespace ed3r::app {
namespace {

const std::string kWorld = ED3R_SOURCE_DIR "/sweeps/worlds/training_b.yaml";

std::string Frames(const std::filesystem::path& out, const std::string& more) {
  return "frames --out " + out.string() + " --world " + kWorld + " " + more;
}

std::vector<std::string> LinesOf(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::vector<std::string> CellsOf(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
  return cells;
}

TEST(FramesCommand, WritesAnArrayLabelsAndAManifestThatAgree) {
  const ScratchFolder scratch;
  const std::filesystem::path out = scratch / "set";
  const CommandResult result = Ed3r(Frames(out, "--views 6 --frames 3 --seed 11 --pictures 1 --size 64x36"));
  ASSERT_EQ(result.status, 0) << result.err;

  const std::string array = ReadAll(out / "frames.npy");
  const std::size_t header =
      10 + static_cast<std::uint8_t>(array[8]) + 256u * static_cast<std::uint8_t>(array[9]);
  EXPECT_EQ(array.substr(0, 8), std::string("\x93NUMPY\x01\x00", 8));
  EXPECT_EQ(header % 64, 0u);
  EXPECT_NE(array.find("'shape': (18, 36, 64, 3)"), std::string::npos);
  EXPECT_EQ(array.size(), header + 18u * 36 * 64 * 3);

  const auto manifest = nlohmann::json::parse(ReadAll(out / "manifest.json"));
  Sha256 hash;
  hash.Update(array);
  EXPECT_EQ(manifest["frames_npy_sha256"], hash.Hex());
  Sha256 of_labels;
  of_labels.Update(ReadAll(out / "labels.csv"));
  EXPECT_EQ(manifest["labels_csv_sha256"], of_labels.Hex());
  EXPECT_EQ(manifest["seed"], 11);
  EXPECT_EQ(manifest["worlds"][0]["name"], "training b");

  const auto lines = LinesOf(ReadAll(out / "labels.csv"));
  ASSERT_EQ(lines.size(), 19u);
  int with_fire = 0;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const auto cells = CellsOf(lines[i]);
    ASSERT_GE(cells.size(), 11u) << lines[i];
    EXPECT_EQ(cells[0], std::to_string(i - 1));
    const bool visible = std::stoi(cells[6]) + std::stoi(cells[7]) > 0;
    EXPECT_EQ(cells[9], visible ? "1" : "0");
    with_fire += cells[2] == "0" && visible;
  }
  EXPECT_EQ(manifest["views_with_fire"], with_fire);
  EXPECT_EQ(manifest["views_without_fire"], 6 - with_fire);
  EXPECT_TRUE(std::filesystem::exists(out / "view_00000.png"));
  EXPECT_TRUE(std::filesystem::exists(out / "view_00000_large.png"));
  EXPECT_FALSE(std::filesystem::exists(out / "view_00001.png"));

  const std::filesystem::path again = scratch / "again";
  ASSERT_EQ(Ed3r(Frames(again, "--views 6 --frames 3 --seed 11 --pictures 0 --size 64x36")).status, 0);
  EXPECT_EQ(ReadAll(again / "frames.npy"), array);
  EXPECT_EQ(ReadAll(again / "labels.csv"), ReadAll(out / "labels.csv"));
}

TEST(FramesCommand, PicturesOfAnEarlierSetDoNotStay) {
  const ScratchFolder scratch;
  const std::filesystem::path out = scratch / "set";
  const std::string size = "--views 4 --frames 1 --size 64x36 ";
  ASSERT_EQ(Ed3r(Frames(out, size + "--seed 11 --pictures 2")).status, 0);
  ASSERT_TRUE(std::filesystem::exists(out / "view_00001_large.png"));
  std::ofstream(out / "view_mine.png") << "mine";
  ASSERT_EQ(Ed3r(Frames(out, size + "--seed 12 --pictures 1")).status, 0);
  EXPECT_TRUE(std::filesystem::exists(out / "view_00000.png"));
  for (const char* name : {"view_00001.png", "view_00001_large.png"})
    EXPECT_FALSE(std::filesystem::exists(out / name)) << name;
  EXPECT_EQ(ReadAll(out / "view_mine.png"), "mine");
}

// The same views as without the option, less those that are judged rightly.
TEST(FramesCommand, KeepsOnlyTheViewsThatADetectorMisjudges) {
  const ScratchFolder scratch;
  const std::string more = "--frames 2 --seed 11 --pictures 0 --size 64x36";
  ASSERT_EQ(Ed3r(Frames(scratch / "all", "--views 60 " + more)).status, 0);
  const CommandResult result = Ed3r(Frames(scratch / "some", "--views 4 --wrong-by 0.3 " + more));
  ASSERT_EQ(result.status, 0) << result.err;
  const auto manifest = nlohmann::json::parse(ReadAll(scratch / "some/manifest.json"));
  EXPECT_GE(manifest["views_looked_at"], 4);
  EXPECT_EQ(manifest["wrong_by"], 0.3);
  const auto all = LinesOf(ReadAll(scratch / "all/labels.csv"));
  const auto some = LinesOf(ReadAll(scratch / "some/labels.csv"));
  ASSERT_EQ(some.size(), 9u);
  int after = -1;
  for (std::size_t i = 1; i < some.size(); ++i) {
    const auto cells = CellsOf(some[i]);
    EXPECT_EQ(cells[0], std::to_string(i - 1));
    const int view = std::stoi(cells[1]);
    EXPECT_GE(view, after);
    after = view;
    if (view >= 60) continue;
    const std::string& same = all[2 * static_cast<std::size_t>(view) + 1 + (i - 1) % 2];
    EXPECT_EQ(some[i].substr(some[i].find(',')), same.substr(same.find(',')));
  }
}

// Wherever it is called; a terminal is told how far it is, and a file is not.
TEST(FramesCommand, TheShippedWorldsAreFound) {
  const ScratchFolder scratch;
  const CommandResult result = Ed3r("frames --out set --views 2 --frames 1 --pictures 0 --size 16x9",
                                    "cd " + scratch.Path().string() + " &&");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.err, "");
  const auto manifest = nlohmann::json::parse(ReadAll(scratch / "set/manifest.json"));
  EXPECT_EQ(manifest["worlds"].size(), 3u);
  EXPECT_NE(
      Ed3r("frames --out set --views 2", "ED3R_SWEEPS=/nowhere").err.find("/nowhere/worlds/training_a.yaml"),
      std::string::npos);
}

TEST(FramesCommand, BadInputIsOneLineAndNothingIsWritten) {
  const ScratchFolder scratch;
  const std::filesystem::path out = scratch / "set";
  for (const std::string bad :
       {"--views 0", "--views 1000001", "--frames 34", "--frames 0", "--size 15x9", "--size 96",
        "--size 96x54x3", "--size 1921x1080", "--pictures -1", "--wrong-by 1.5", "--wrong-by -0.1",
        "--world nowhere.yaml", "--set perception.render.noise=41", "--set perception.render.nose=1"}) {
    const CommandResult result = Ed3r(Frames(out, bad));
    EXPECT_EQ(result.status, 2) << bad;
    EXPECT_EQ(LinesOf(result.err).size(), 1u) << bad << ": " << result.err;
    EXPECT_FALSE(std::filesystem::exists(out)) << bad;
  }
  // A file stands where the folder should go.
  std::ofstream(scratch / "file") << "x";
  const CommandResult result = Ed3r(Frames(scratch / "file", "--views 1"));
  EXPECT_EQ(result.status, 2);
  EXPECT_EQ(LinesOf(result.err).size(), 1u) << result.err;
}

}  // namespace
}  // namespace ed3r::app
