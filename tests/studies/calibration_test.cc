// The fence: what was calibrated on the RBS row does not change without the record of its search.
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <fstream>
#include <set>
#include <sstream>

#include "engine/config/parameters.h"
#include "engine/core/sha256.h"
#include "studies/paper/csv.h"

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
    if (key == "world_sha256") continue;
    Config frozen;
    ASSERT_EQ(SetParameter(frozen, key, value), "");
    EXPECT_EQ(GetParameter(defaults, key), GetParameter(frozen, key)) << key;
    ++compared;
  }
  EXPECT_GE(compared, 8);
}

TEST(CalibrationTest, ExactlyTheFrozenParametersSayThatTheyAreCalibrated) {
  std::set<std::string> frozen, said;
  for (const auto& entry : YAML::LoadFile(kFolder + "calibration/frozen.yaml")) {
    const std::string key = entry.first.as<std::string>();
    if (key != "world_sha256") frozen.insert(key);
  }
  for (const ParameterInfo& parameter : Parameters())
    if (parameter.source.find("calibrated") != std::string::npos) said.insert(parameter.key);
  EXPECT_EQ(said, frozen);
}

TEST(CalibrationTest, TheWorldIsTheOneThatWasCalibratedIn) {
  const YAML::Node frozen = YAML::LoadFile(kFolder + "calibration/frozen.yaml");
  Sha256 hash;
  hash.Update(Content(kFolder + "worlds/ridges.yaml"));
  EXPECT_EQ(hash.Hex(), frozen["world_sha256"].as<std::string>());
}

TEST(CalibrationTest, TheFrozenPointIsTheBestOfTheRecord) {
  const std::vector<CsvRow> rows = ParseCsv(Content(kFolder + "calibration/record.csv"), "record.csv");
  const auto column = [&](const std::string& name) {
    return static_cast<std::size_t>(std::find(rows[0].begin(), rows[0].end(), name) - rows[0].begin());
  };
  const std::size_t loss = column("loss"), frozen = column("frozen");
  double least = 1e300, of_frozen = -1;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    least = std::min(least, std::stod(rows[i].at(loss)));
    if (rows[i].at(frozen) == "yes") of_frozen = std::stod(rows[i].at(loss));
  }
  EXPECT_EQ(of_frozen, least);
  EXPECT_GE(rows.size(), 41u);
}

}  // namespace
}  // namespace ed3r
