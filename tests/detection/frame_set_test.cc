#include "studies/detection/frame_set.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "engine/core/check.h"
#include "engine/core/sha256.h"

namespace ed3r::detection {
namespace {

namespace fs = std::filesystem;

class FrameSetTest : public testing::Test {
 protected:
  FrameSetTest() : folder_(fs::temp_directory_path() / ("ed3r-frames-" + std::to_string(::getpid()))) {
    fs::create_directories(folder_);
    WriteNpy("(2, 2, 3, 3)", 36);
    WriteLabels(
        "index,view,frame,world,site,distance_m,fire_px,smoke_px,occluded,label\n"
        "0,7,0,\"a, b\",x,12.5,3,4,0.25,1\n"
        "1,7,1,\"a, b\",x,12.5,0,0,0,0\n");
  }
  ~FrameSetTest() override { fs::remove_all(folder_); }

  void WriteNpy(const std::string& shape, int bytes, const std::string& type = "|u1") {
    std::string header = "{'descr': '" + type + "', 'fortran_order': False, 'shape': " + shape + ", }";
    header.append(117 - header.size(), ' ');
    header += '\n';
    std::ofstream file(folder_ / "frames.npy", std::ios::binary);
    file << std::string("\x93NUMPY\x01\x00", 8) << static_cast<char>(header.size()) << '\0' << header;
    for (int i = 0; i < bytes; ++i) file << static_cast<char>(i);
  }
  void WriteLabels(const std::string& text) { std::ofstream(folder_ / "labels.csv") << text; }

  void ExpectRefusal(const std::string& part) {
    try {
      ReadFrameSet(folder_);
      ADD_FAILURE() << part;
    } catch (const UserError& error) {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
  }

  fs::path folder_;
};

TEST_F(FrameSetTest, ReadsFramesAndLabels) {
  ASSERT_TRUE(IsFrameSet(folder_));
  const FrameSet set = ReadFrameSet(folder_);
  EXPECT_EQ(set.frames.frames(), 2);
  EXPECT_EQ(set.frames.height_px(), 2);
  EXPECT_EQ(set.frames.width_px(), 3);
  const perception::FrameStack second = set.frames.Some(1, 1);
  EXPECT_EQ(second.frames, 1);
  ASSERT_EQ(second.rgb.size(), 18u);
  EXPECT_EQ(second.rgb.front(), 18);
  EXPECT_EQ(second.rgb.back(), 35);
  EXPECT_EQ(set.labels[0].world, "a, b");
  EXPECT_EQ(set.labels[0].view, 7);
  EXPECT_EQ(set.labels[0].occluded, 0.25);
  EXPECT_TRUE(set.labels[0].positive);
  EXPECT_FALSE(set.labels[1].positive);
}

TEST_F(FrameSetTest, RefusesFilesThatDoNotFit) {
  WriteNpy("(2, 2, 3, 3)", 35);
  ExpectRefusal("damaged");
  WriteNpy("(2, 2, 3)", 12);
  ExpectRefusal("frames x height x width x 3");
  WriteNpy("(2, 2 3, 3, 3)", 36 * 3);
  ExpectRefusal("frames x height x width x 3");
  WriteNpy("(2, 2, 3, 3)", 36, "<f4");
  ExpectRefusal("uint8");
  WriteNpy("(2, 2, 3, 3)", 36, "|u1', 'descr': '|i1");
  ExpectRefusal("uint8");
  WriteNpy("(3, 2, 3, 3)", 54);
  ExpectRefusal("2 rows for 3 frames");
  std::ofstream(folder_ / "frames.npy") << "nothing";
  ExpectRefusal("no NPY");
}

TEST_F(FrameSetTest, ReadsAHeaderThatIsWrittenOtherwise) {
  WriteNpy("( 2,2 ,3, 3 )", 36);
  EXPECT_EQ(ReadFrameSet(folder_).frames.width_px(), 3);
}

TEST_F(FrameSetTest, RefusesFilesOfAnotherManifest) {
  const auto hash = [&](const char* file) {
    std::ifstream in(folder_ / file, std::ios::binary);
    Sha256 sha;
    sha.Update(std::string(std::istreambuf_iterator<char>(in), {}));
    return sha.Hex();
  };
  std::ofstream(folder_ / "manifest.json") << "{\"frames_npy_sha256\": \"" << hash("frames.npy")
                                           << "\", \"labels_csv_sha256\": \"" << hash("labels.csv") << "\"}";
  EXPECT_EQ(ReadFrameSet(folder_).frames.frames(), 2);
  WriteLabels(
      "index,view,frame,world,site,distance_m,fire_px,smoke_px,occluded,label\n"
      "0,7,0,a,x,12.5,0,0,0,0\n1,7,1,a,x,12.5,3,4,0.25,1\n");
  ExpectRefusal("labels.csv: not the file of the manifest.json beside it");
  std::ofstream(folder_ / "manifest.json") << "{\"frames_npy_sha256\": \"00\"}";
  ExpectRefusal("frames.npy: not the file of the manifest.json beside it");
  std::ofstream(folder_ / "manifest.json") << "{}";
  EXPECT_EQ(ReadFrameSet(folder_).labels.size(), 2u) << "a manifest of somebody else's";
  std::ofstream(folder_ / "manifest.json") << "none";
  ExpectRefusal("manifest.json: no JSON");
  std::ofstream(folder_ / "manifest.json") << "[]";
  ExpectRefusal("manifest.json: is array, not a JSON object; take it away to read the set without");
  fs::remove(folder_ / "manifest.json");
  fs::create_symlink(folder_ / "nowhere", folder_ / "manifest.json");
  ExpectRefusal("manifest.json: cannot be read: No such file or directory");
}

TEST_F(FrameSetTest, RefusesLabelsWithoutAColumn) {
  WriteLabels("index,view\n0,1\n1,1\n");
  ExpectRefusal("world");
}

// A sorted table labelled other frames.
TEST_F(FrameSetTest, RefusesLabelsInAnotherOrder) {
  const std::string names = "index,view,frame,world,site,distance_m,fire_px,smoke_px,occluded,label\n";
  WriteLabels(names + "1,7,1,a,x,12.5,0,0,0,0\n0,7,0,a,x,12.5,3,4,0.25,1\n");
  ExpectRefusal(
      "labels.csv:3:1: index: 0 stands below 1; allowed: rows in the order of their frames, each once; "
      "sort them by index");
  WriteLabels(names + "0,7,0,a,x,12.5,0,0,0,0\n0,7,0,a,x,12.5,3,4,0.25,1\n");
  ExpectRefusal(
      "labels.csv:3:1: index: 0 stands below 0; allowed: rows in the order of their frames, each once; "
      "sort them by index");
  std::string capital = names;
  capital.front() = 'I';
  WriteLabels(capital + "1,7,1,a,x,12.5,0,0,0,0\n0,7,0,a,x,12.5,3,4,0.25,1\n");
  ExpectRefusal("labels.csv:3:1: Index: 0 stands below 1; allowed: rows in the order of their frames");
  WriteLabels(names + "3,7,1,a,x,12.5,0,0,0,0\n8,7,0,a,x,12.5,3,4,0.25,1\n");  // frames of a larger set
  EXPECT_TRUE(ReadFrameSet(folder_).labels[1].positive);
}

// Any number above 0 was a fire, and a view's fraction was cut away.
TEST_F(FrameSetTest, RefusesFractionsOfLabelsAndViews) {
  const std::string names = "world,view,distance_m,fire_px,smoke_px,occluded,label\n";
  WriteLabels(names + "a,0,12.5,0,0,0,0\na,0,12.5,3,4,0.25,0.3\n");
  ExpectRefusal("labels.csv:3:19: label: 0.3 is not allowed; allowed: a whole number of 0 .. 1");
  WriteLabels(names + "a,0,12.5,0,0,0,0\na,0.4,12.5,3,4,0.25,1\n");
  ExpectRefusal("labels.csv:3:3: view: 0.4 is not allowed; allowed: a whole number of 0 .. 1000000000");
  WriteLabels(names + "a,0.0,12.5,0,0,0,0\na,1e0,12.5,3,4,0.25,1.0\n");
  EXPECT_TRUE(ReadFrameSet(folder_).labels[1].positive);
}

TEST_F(FrameSetTest, FoldersWithoutPicturesAreRefused) {
  EXPECT_THROW(ListPictures(folder_ / "nowhere.png"), UserError);
  fs::create_directories(folder_ / "fire");
  try {
    ListPictures(folder_);
    ADD_FAILURE() << "a folder without pictures";
  } catch (const UserError& error) {
    EXPECT_NE(std::string(error.what()).find("pictures (.png, .jpg, .jpeg); folders within, such as 'fire'"),
              std::string::npos)
        << error.what();
  }
  std::ofstream(folder_ / "b.JPG") << "no picture";
  std::ofstream(folder_ / "a.png") << "no picture";
  const PictureList list = ListPictures(folder_);
  EXPECT_EQ(list.paths, (std::vector<std::string>{folder_ / "a.png", folder_ / "b.JPG"}));
  EXPECT_EQ(list.passed_over, 2);  // frames.npy and labels.csv
  EXPECT_THROW(ReadNamedPicture(list.paths.front()), UserError);
}

}  // namespace
}  // namespace ed3r::detection
