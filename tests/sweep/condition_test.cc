#include "engine/sweep/condition.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "engine/core/check.h"

namespace ed3r::sweep {
namespace {

Condition Parsed(const std::string& text) {
  YamlNode node;
  node.kind = YamlNode::Kind::kScalar;
  node.at = "f:1:1";
  node.text = text;
  return Condition::Parse(node, SettingReader("", "", false, {}));
}

// Under a configuration with eta_min 0.75, eta_int 0.2, strategy rbs, all sites, early completion on.
bool Holds(const std::string& text) { return Parsed(text).Holds(Config()); }

std::string Refusal(const std::string& text) {
  try {
    Parsed(text);
  } catch (const UserError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(ConditionTest, ComparesNumbersExactly) {
  EXPECT_TRUE(Holds("agents.eta_min == 0.75"));
  EXPECT_TRUE(Holds("agents.eta_min == 7.5e-1"));
  EXPECT_FALSE(Holds("agents.eta_min == 0.7500000001"));
  EXPECT_TRUE(Holds("agents.eta_min != 0.7500000001"));
  EXPECT_TRUE(Holds("agents.eta_min < 0.8"));
  EXPECT_FALSE(Holds("agents.eta_min < 0.75"));
  EXPECT_TRUE(Holds("agents.eta_min <= 0.75"));
  EXPECT_FALSE(Holds("agents.eta_min > 0.75"));
  EXPECT_TRUE(Holds("agents.eta_min >= 0.75"));
  EXPECT_TRUE(Holds("0.8 > agents.eta_min"));
  EXPECT_TRUE(Holds("environment.wind_x_mps > -5"));
  // As numbers, not as text.
  EXPECT_TRUE(Holds("agents.candidates > 999"));
}

TEST(ConditionTest, ComparesParametersWithEachOther) {
  EXPECT_TRUE(Holds("agents.eta_int < agents.eta_min"));
  EXPECT_TRUE(Holds("mission.sites == mission.base_stations"));
}

TEST(ConditionTest, ComparesWords) {
  EXPECT_TRUE(Holds("strategy == rbs"));
  EXPECT_TRUE(Holds("mission.strategy != ablation-1"));
  EXPECT_TRUE(Holds("strategy == 'rbs'"));
  EXPECT_TRUE(Holds("strategy != \"a word (or two)\""));
  EXPECT_TRUE(Holds("mission.sites==all"));
  EXPECT_TRUE(Holds("agents.early_completion == true"));
}

TEST(ConditionTest, AFileIsOneByWhateverName) {
  const std::filesystem::path sweeps = ED3R_SOURCE_DIR "/sweeps";
  Config config;
  config.mission.world = (sweeps / "worlds/ridges.yaml").string();
  const auto holds = [&](const std::filesystem::path& file) {
    return Parsed("mission.world == '" + file.string() + "'").Holds(config);
  };
  EXPECT_TRUE(holds(sweeps / "worlds/ridges.yaml"));
  EXPECT_TRUE(holds(sweeps / "worlds/./../worlds/ridges.yaml"));
  EXPECT_TRUE(holds(std::filesystem::relative(config.mission.world)));
  const std::filesystem::path link = std::filesystem::path(::testing::TempDir()) / "ed3r_condition_link.yaml";
  std::filesystem::remove(link);
  std::filesystem::create_symlink(config.mission.world, link);
  EXPECT_TRUE(holds(link));
  std::filesystem::remove(link);
  EXPECT_FALSE(holds(sweeps / "worlds/cascades.yaml"));
}

TEST(ConditionTest, NotBindsTighterThanAndThanOr) {
  const std::string t = "strategy == rbs";
  const std::string f = "strategy == ed3r";
  EXPECT_TRUE(Holds(t + " or " + f + " and " + f));
  EXPECT_FALSE(Holds("(" + t + " or " + f + ") and " + f));
  EXPECT_TRUE(Holds(f + " and " + f + " or " + t));
  EXPECT_FALSE(Holds("not " + t + " or " + f));
  EXPECT_TRUE(Holds("not (" + f + " and " + t + ")"));
  EXPECT_TRUE(Holds("not not " + t));
  EXPECT_FALSE(Holds("not " + f + " and " + f));
}

TEST(ConditionTest, RefusalsNameThePlaceAndWhatIsAllowed) {
  const std::string at = "f:1:1: where: ";
  EXPECT_EQ(Refusal("strategy"),
            at + "its end is not allowed at character 9 of the condition; allowed: == != < <= > >=");
  EXPECT_EQ(Refusal("strategy == "),
            at + "its end is not allowed at character 13 of the condition; allowed: a parameter or a value");
  EXPECT_EQ(Refusal("strategy == and"),
            at + "'and' is not allowed at character 13 of the condition; allowed: a parameter or a value");
  EXPECT_EQ(
      Refusal("strategy == rbs strategy"),
      at + "'strategy' is not allowed at character 17 of the condition; allowed: 'and', 'or' or the end");
  EXPECT_EQ(Refusal("0.1 < agents.eta_int < 0.9"),
            at + "'<' is not allowed at character 22 of the condition; allowed: 'and', 'or' or the end");
  EXPECT_EQ(Refusal("strategy == 'rbs"),
            at + "''rbs' is not allowed at character 13 of the condition; allowed: text that ends with '");
  EXPECT_EQ(Refusal("(strategy == rbs))"),
            at + "')' is not allowed at character 18 of the condition; allowed: 'and', 'or' or the end");
  EXPECT_EQ(Refusal("strategy =! rbs"),
            at + "'=!' is not allowed at character 10 of the condition; allowed: == != < <= > >=");
  EXPECT_EQ(Refusal("agents.eta_mim < 1"),
            at + "neither 'agents.eta_mim' nor '1' is a parameter of a mission; did "
                 "you mean agents.eta_min?");
  EXPECT_EQ(Refusal("robot.mass_kg == heavy"),
            "f:1:1: robot.mass_kg: 'heavy' is not allowed; allowed: 0.05 .. 50 kg");
  EXPECT_EQ(
      Refusal("cpu.frequency_hz == 2e9"),
      at +
          "neither 'cpu.frequency_hz' nor '2e9' is a parameter of a mission; did you mean cpu.frequency_hz?");
  EXPECT_EQ(Refusal(""),
            at + "its end is not allowed at character 1 of the condition; allowed: a parameter or a value");
}

TEST(ConditionTest, DeepNestingIsRead) {
  const std::string deep = std::string(490, '(') + "strategy == rbs" + std::string(490, ')');
  EXPECT_TRUE(Holds(deep));
}

}  // namespace
}  // namespace ed3r::sweep
