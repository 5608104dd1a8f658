#include "engine/config/parameters.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace ed3r {
namespace {

TEST(ParametersTest, EveryKeyIsUniqueDocumentedAndReadsBack) {
  std::set<std::string> keys;
  for (const ParameterInfo& parameter : Parameters()) {
    EXPECT_TRUE(keys.insert(parameter.key).second) << parameter.key;
    EXPECT_FALSE(parameter.source.empty()) << parameter.key;
    EXPECT_FALSE(parameter.meaning.empty()) << parameter.key;
    Config config;
    EXPECT_EQ(SetParameter(config, parameter.key, parameter.default_value, Scope::kPhysicsOnly), "");
    EXPECT_EQ(GetParameter(config, parameter.key), parameter.default_value);
  }
}

TEST(ParametersTest, DefaultsObeyTheRules) { EXPECT_EQ(CheckParameters(Config()), ""); }

TEST(ParametersTest, RefusalsNameKeyValueAndRange) {
  Config config;
  EXPECT_EQ(SetParameter(config, "robot.mass_kg", "-1"),
            "robot.mass_kg: '-1' is not allowed; allowed: 0.05 .. 50 kg");
  EXPECT_EQ(SetParameter(config, "robot.mass_kg", "heavy"),
            "robot.mass_kg: 'heavy' is not allowed; allowed: 0.05 .. 50 kg");
  EXPECT_EQ(SetParameter(config, "robot.mass_kg", "nan"),
            "robot.mass_kg: 'nan' is not allowed; allowed: 0.05 .. 50 kg");
  EXPECT_EQ(SetParameter(config, "robot.propellers", "4.5"),
            "robot.propellers: '4.5' is not allowed; allowed: 3 .. 16");
  EXPECT_EQ(SetParameter(config, "energy.hover_form", "real"),
            "energy.hover_form: 'real' is not allowed; allowed: physical | printed");
  EXPECT_EQ(SetParameter(config, "robot.mas_kg", "2"),
            "robot.mas_kg: unknown key; did you mean robot.mass_kg?");
  EXPECT_EQ(SetParameter(config, "cpu.frequency_hz", "2e9"),
            "cpu.frequency_hz: is a value of 'ed3r physics' only; in a mission it is drawn per timestep");
  EXPECT_EQ(CanonicalText(config), CanonicalText(Config()));
}

TEST(ParametersTest, FilesAreWhatTheirDescriptionsCallSo) {
  std::vector<std::string> files;
  for (const ParameterInfo& parameter : Parameters())
    if (parameter.is_file) files.push_back(parameter.key + " | " + parameter.or_else);
  EXPECT_EQ(files, (std::vector<std::string>{"mission.world | ", "perception.detector.full | builtin",
                                             "perception.detector.quantized | builtin",
                                             "networks.rc | trained", "networks.robot | trained"}));
}

TEST(ParametersTest, RulesBetweenParameters) {
  Config config;
  config.agents.eta_int = 0.9;
  EXPECT_EQ(CheckParameters(config), "agents.eta_int: '0.9' is not allowed; at most agents.eta_min = 0.75");
  config = Config();
  config.sensing.lidar_rate_hz = 240;
  EXPECT_EQ(CheckParameters(config),
            "sensing.lidar_rate_hz: '240' is not allowed; at most mission.physics_hz = 120");
}

TEST(ParametersTest, CanonicalTextTellsConfigsApart) {
  Config a;
  Config b;
  EXPECT_EQ(CanonicalText(a), CanonicalText(b));
  b.robot.mass_kg = std::nextafter(a.robot.mass_kg, 2.0);
  EXPECT_NE(CanonicalText(a), CanonicalText(b));
}

}  // namespace
}  // namespace ed3r
