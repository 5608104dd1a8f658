// The fence: what was calibrated on the paper's random walk does not change without the record of its search.
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <fstream>
#include <set>
#include <sstream>

#include "engine/config/parameters.h"
#include "engine/core/sha256.h"
#include "tests/studies/csv_rows.h"

namespace ed3r {
namespace {

const std::string kFolder = ED3R_SOURCE_DIR "/sweeps/";

std::string Content(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  EXPECT_TRUE(in) << file;
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

TEST(CalibrationTest, DefaultsAreTheFrozenOnes) {
  const Config defaults;
  int compared = 0;
  for (const auto& entry : YAML::LoadFile(kFolder + "calibration/frozen.yaml")) {
    const std::string key = entry.first.as<std::string>(), value = entry.second.as<std::string>();
    if (key.ends_with("_sha256")) continue;
    Config frozen;
    ASSERT_EQ(SetParameter(frozen, key, value), "");
    EXPECT_EQ(GetParameter(defaults, key), GetParameter(frozen, key)) << key;
    ++compared;
  }
  EXPECT_GE(compared, 19);
}

TEST(CalibrationTest, ExactlyTheFrozenParametersSayThatTheyAreCalibrated) {
  std::set<std::string> frozen, said;
  for (const auto& entry : YAML::LoadFile(kFolder + "calibration/frozen.yaml")) {
    const std::string key = entry.first.as<std::string>();
    if (!key.ends_with("_sha256")) frozen.insert(key);
  }
  frozen.insert("perception.full.distractor_gain");  // 1, the unit that Quantized's is told in
  for (const ParameterInfo& parameter : Parameters()) {
    if (parameter.source.find("calibrated") == std::string::npos) continue;
    said.insert(parameter.key);
  }
  EXPECT_EQ(said, frozen);
}

std::string HashOf(const std::string& file) {
  Sha256 hash;
  hash.Update(Content(file));
  return hash.Hex();
}

TEST(CalibrationTest, TheWorldIsTheOneThatWasCalibratedIn) {
  const YAML::Node frozen = YAML::LoadFile(kFolder + "calibration/frozen.yaml");
  EXPECT_EQ(HashOf(kFolder + "worlds/paper.yaml"), frozen["world_sha256"].as<std::string>());
  EXPECT_EQ(HashOf(kFolder + "worlds/ridges.yaml"), frozen["terrain_sha256"].as<std::string>());
  EXPECT_EQ(Config().mission.world, "worlds/paper.yaml");
}

struct Record {
  std::vector<CsvRow> rows;
  std::size_t Column(const std::string& name) const {
    return static_cast<std::size_t>(std::find(rows[0].begin(), rows[0].end(), name) - rows[0].begin());
  }
};

// One row is marked, of the wave that judges (JUDGING in scripts/calibrate.py), and it is the first of the worlds that are kept.
TEST(CalibrationTest, TheFrozenPointIsOfTheRecord) {
  const Record record{CsvRows(Content(kFolder + "calibration/record.csv"))};
  const Record matched{CsvRows(Content(kFolder + "calibration/matched.csv"))};
  const std::size_t wave = record.Column("wave"), frozen = record.Column("frozen");
  constexpr int kJudging = 10;
  int marked = 0;
  for (std::size_t i = 1; i < record.rows.size(); ++i) {
    const CsvRow& row = record.rows[i];
    if (row.at(frozen) != "yes") continue;
    ++marked;
    EXPECT_EQ(std::stoi(row.at(wave)), kJudging);
    for (const char* column : {"half_signal", "site_distance_m", "energy_kj", "implausibility"})
      EXPECT_EQ(row.at(record.Column(column)), matched.rows.at(1).at(matched.Column(column))) << column;
  }
  EXPECT_EQ(marked, 1);
  EXPECT_GE(record.rows.size(), 300u);
}

// Every world that is kept is one of the record's, with a world file of its own.
TEST(CalibrationTest, TheMatchedWorldsAreThere) {
  const Record matched{CsvRows(Content(kFolder + "calibration/matched.csv"))};
  ASSERT_GE(matched.rows.size(), 22u);  // the header, the default and twenty others
  for (std::size_t i = 1; i < matched.rows.size(); ++i) {
    const std::string& name = matched.rows[i].at(matched.Column("world"));
    EXPECT_FALSE(Content(kFolder + (i == 1 ? "worlds/" : "worlds/matched/") + name + ".yaml").empty())
        << name;
  }
}

}  // namespace
}  // namespace ed3r
