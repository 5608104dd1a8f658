// World files, grids and stem maps that a test writes for itself, in a folder of its own.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

namespace ed3r::world {

class TestFolder {
 public:
  TestFolder() {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    path_ = std::filesystem::path(::testing::TempDir()) /
            (std::string("ed3r_world_") + test->test_suite_name() + "_" + test->name());
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~TestFolder() { std::filesystem::remove_all(path_); }
  TestFolder(const TestFolder&) = delete;
  TestFolder& operator=(const TestFolder&) = delete;

  std::string Path(const std::string& name) const { return (path_ / name).string(); }

  std::string Write(const std::string& name, const std::string& text) const {
    std::ofstream(Path(name), std::ios::binary) << text;
    return Path(name);
  }

  // An ESRI ASCII grid of square cells; heights by column and by row from the south.
  std::string WriteGrid(const std::string& name, int columns, int rows, double cell_m,
                        const std::function<double(int, int)>& height_m) const {
    std::ofstream file(Path(name));
    file << "ncols " << columns << "\nnrows " << rows << "\nxllcorner 1000\nyllcorner 2000\ncellsize "
         << cell_m << "\nNODATA_value -9999\n";
    file.precision(10);
    for (int row = rows - 1; row >= 0; --row)
      for (int column = 0; column < columns; ++column)
        file << height_m(column, row) << (column + 1 < columns ? ' ' : '\n');
    return Path(name);
  }

 private:
  std::filesystem::path path_;
};

// A small valid world on a grid file: 100 x 80 m, one site, one station.
inline std::string GridWorld(const std::string& grid_keys) {
  return "name: small\nsize_m: [100, 80, 165]\nterrain:\n  cell_m: 2\n  grid:\n" + grid_keys +
         "sites:\n  - {name: a, at_m: [20, 20]}\nbase_stations:\n  - {name: b, at_m: [60, 60]}\n"
         "start: {at_m: [50, 40], radius_m: 5, height_m: [20, 40]}\n";
}

}  // namespace ed3r::world
