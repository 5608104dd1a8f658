#include "engine/world/map_picture.h"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "engine/core/check.h"
#include "tests/world/scene_builder.h"
#include "tests/world/world_files.h"

namespace ed3r::world {
namespace {

Scene::Parts Slope() {
  Scene::Parts parts = PartsOf(51, 2.0, [](double x_m, double) { return 0.5 * x_m; });
  parts.sites = {{.name = "known", .base_m = {20, 80, 10}, .known = true},
                 {.name = "unseen", .base_m = {80, 80, 40}}};
  parts.base_stations = {{.name = "mast", .antenna_m = {50, 50, 35}, .known = true}};
  parts.start = {.x_m = 50, .y_m = 20, .radius_m = 8, .height_min_m = 20, .height_max_m = 40};
  return parts;
}

// Where a point of the 100 m x 100 m area lies in a picture 1200 px wide: the map fills 62 .. 922 px across.
cv::Vec3b Pixel(const cv::Mat& picture, double x_m, double y_m) {
  return picture.at<cv::Vec3b>(static_cast<int>(72 + 8.6 * (100 - y_m)), static_cast<int>(62 + 8.6 * x_m));
}

TEST(MapPicture, ShowsSitesStationsAndRelief) {
  const TestFolder folder;
  WriteMapPicture(Scene(Slope()), folder.Path("map.png"));
  const cv::Mat picture = cv::imread(folder.Path("map.png"));
  ASSERT_EQ(picture.cols, 1200);
  ASSERT_GT(picture.rows, 900);
  // Beside the sites' numbers: orange where known, crimson where not (blue, green, red).
  const cv::Vec3b known = Pixel(picture, 19.0, 80.6);
  EXPECT_GT(known[2], 230);
  EXPECT_GT(known[1], 100);
  EXPECT_LT(known[0], 60);
  const cv::Vec3b unseen = Pixel(picture, 79.0, 80.6);
  EXPECT_GT(unseen[2], 150);
  EXPECT_LT(unseen[1], 60);
  const cv::Vec3b station = Pixel(picture, 50.0, 50.0);
  EXPECT_GT(station[0], 150);
  EXPECT_LT(station[2], 60);
  // Low ground is greener than red, high ground is not.
  EXPECT_GT(Pixel(picture, 5.0, 61.0)[1], Pixel(picture, 5.0, 61.0)[2]);
  EXPECT_GE(Pixel(picture, 95.0, 61.0)[2], Pixel(picture, 95.0, 61.0)[1]);
}

TEST(MapPicture, DrawsTrees) {
  const TestFolder folder;
  Scene::Parts parts = Slope();
  WriteMapPicture(Scene(parts), folder.Path("bare.png"));
  parts.trees = {{.x_m = 10,
                  .y_m = 50,
                  .ground_m = 5,
                  .height_m = 20,
                  .trunk_radius_m = 0.2,
                  .crown_radius_m = 3,
                  .crown_depth_m = 10}};
  WriteMapPicture(Scene(parts), folder.Path("tree.png"));
  const cv::Vec3b bare = Pixel(cv::imread(folder.Path("bare.png")), 10.5, 49.5);
  const cv::Vec3b tree = Pixel(cv::imread(folder.Path("tree.png")), 10.5, 49.5);
  EXPECT_LT(tree[1] + 40, bare[1]);
  EXPECT_GT(tree[1], tree[2]);
}

TEST(MapPicture, IsAsWideAsAskedAndHandlesJpeg) {
  const TestFolder folder;
  WriteMapPicture(Scene(Slope()), folder.Path("map.jpg"), {}, 400);
  EXPECT_EQ(cv::imread(folder.Path("map.jpg")).cols, 400);
}

std::string Refusal(const std::string& path) {
  try {
    WriteMapPicture(Scene(Slope()), path, {}, 400);
  } catch (const UserError& error) {
    return error.what();
  }
  return "no error";
}

TEST(MapPicture, RefusesPathsThatCannotBeWritten) {
  const TestFolder folder;
  const std::string nowhere = folder.Path("none/map.png");
  EXPECT_EQ(Refusal(nowhere), nowhere + ": cannot be written: No such file or directory");
  const std::string unknown = folder.Path("map.xyz");
  EXPECT_EQ(Refusal(unknown), unknown + ": cannot be written; allowed endings: .png, .jpg");
  EXPECT_FALSE(std::filesystem::exists(unknown));
}

}  // namespace
}  // namespace ed3r::world
