// A stored mission looked at again: what 'ed3r explain' and 'ed3r replay' say and write.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "engine/store/reader.h"
#include "engine/store/store.h"
#include "tests/app/command.h"

namespace ed3r::app {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

void Fly(const std::string& sweep, const std::string& arguments, const fs::path& dir) {
  const CommandResult result = Ed3r(
      fmt::format("run " ED3R_SOURCE_DIR "/sweeps/{} {} --quiet --out {}", sweep, arguments, dir.string()));
  ASSERT_EQ(result.status, 0) << result.err;
}

// One small run for all tests that only read it.
class ExplainTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    scratch_ = new ScratchFolder;
    Fly("rbs.yaml", "--missions 4", *scratch_ / "run");
  }
  static void TearDownTestSuite() { delete scratch_; }

  static std::string Dir() { return (*scratch_ / "run").string(); }

  static void ExpectRefusal(const std::string& arguments, const std::string& message) {
    const CommandResult result = Ed3r(arguments);
    EXPECT_EQ(result.status, 2) << arguments;
    EXPECT_EQ(result.err, message + "\n") << arguments;
    EXPECT_EQ(result.out, "") << arguments;
  }

 private:
  static ScratchFolder* scratch_;
};

ScratchFolder* ExplainTest::scratch_ = nullptr;

bool Contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

// The rules of the paper's appendix (R25), stated again.
std::string ByTheRules(const json& rules) {
  const double rate = rules["rate_ratio"].get<double>() - rules["transmission_threshold"].get<double>();
  const double cpu = rules["cpu_ratio"].get<double>() - rules["processing_threshold"].get<double>();
  bool offload = rate > cpu;
  if (rate > 0 && cpu > 0) offload = rules["where_draw"].get<double>() < 0.5;
  if (offload) return "offload";
  return rules["model_draw"].get<double>() < 0.5 ? "full" : "quantized";
}

// Timesteps of one mission after the other until both kinds were seen: where a coin decided, and where none was asked. In a
// world whose base stations are near enough for that.
TEST_F(ExplainTest, ARuleBasedTimestepShowsTheRulesInputs) {
  const ScratchFolder near;
  Fly("rbs.yaml", "--missions 4 --set mission.world=" ED3R_SOURCE_DIR "/sweeps/worlds/ridges.yaml",
      near / "run");
  bool coin = false, no_coin = false;
  for (int i = 0; i < 12 && !(coin && no_coin); ++i) {
    const std::string command =
        fmt::format("explain {} rbs/{} --step {}", (near / "run").string(), 1 + i / 4, 1 + i % 4);
    const CommandResult result = Ed3r(command + " --json");
    if (result.status == 2) continue;  // a short mission
    const json told = json::parse(result.out);
    const json& rules = told["rules"];
    EXPECT_EQ(told["execution_by"], "rules");
    EXPECT_FALSE(told.contains("robot_predicted_rewards"));
    EXPECT_TRUE(told["timestep"]["rc_predicted_reward"].is_null());
    EXPECT_EQ(told["execution"], ByTheRules(rules)) << result.out;
    EXPECT_NEAR(rules["cpu_ratio"].get<double>() * 3.2e9, told["timestep"]["cpu_hz"].get<double>(), 1.0);
    (rules.contains("where_draw") ? coin : no_coin) = true;

    const std::string text = Ed3r(command).out;
    EXPECT_FALSE(Contains(text, "nan")) << text;
    for (const auto& [exceeds, key] : {std::pair{"rate_exceeds", "transmission_threshold"},
                                       std::pair{"cpu_exceeds", "processing_threshold"}})
      EXPECT_TRUE(Contains(text, fmt::format(": {} rbs.{} {}\n", rules[exceeds] ? "above" : "not above", key,
                                             rules[key].get<double>())))
          << text;
    EXPECT_EQ(Contains(text, "by a coin, as both are above (draw "), rules.contains("where_draw")) << text;
    EXPECT_TRUE(Contains(text, fmt::format("  > {}\n", told["execution"].get<std::string>()))) << text;
  }
  EXPECT_TRUE(coin && no_coin) << "the missions show both kinds of timestep";
}

TEST_F(ExplainTest, AModelThatIsNoCoinIsToldAsSuch) {
  const ScratchFolder scratch;
  Fly("rbs.yaml", "--missions 1 --set rbs.model=full --set rbs.transmission_threshold=1", scratch / "run");
  const std::string text = Ed3r(fmt::format("explain {} rbs/0 --step 1", (scratch / "run").string())).out;
  EXPECT_TRUE(Contains(text, "  model: as rbs.model says\n  > full\n")) << text;
}

TEST_F(ExplainTest, ARandomOrFixedChoiceIsToldAsSuch) {
  const ScratchFolder scratch;
  const std::pair<const char*, const char*> cases[] = {
      {"random", ": drawn at random from offload, full, quantized\n"},
      {"random-offload", "  > offload: the only execution of this strategy\n"}};
  for (const auto& [strategy, said] : cases) {
    const fs::path dir = scratch / strategy;
    Fly("rbs.yaml", fmt::format("--missions 1 --set mission.strategy={}", strategy), dir);
    const std::string arm = json::parse(Ed3r("status --json " + dir.string()).out)["arms"][0]["arm"];
    const std::string text = Ed3r(fmt::format("explain {} {}/0 --step 2", dir.string(), arm)).out;
    EXPECT_TRUE(Contains(text, said)) << text;
    EXPECT_FALSE(Contains(text, "nan")) << text;
  }
}

TEST_F(ExplainTest, NetworksTellTheirPredictions) {
  const ScratchFolder scratch;
  Fly("smoke.yaml",
      fmt::format("--missions 6 --set training.epochs=3 --cache {}", (scratch / "cache").string()),
      scratch / "run");
  const std::string explain = fmt::format("explain {} --cache {} --step 1 ", (scratch / "run").string(),
                                          (scratch / "cache").string());
  const json told = json::parse(Ed3r(explain + "ed3r-75/3 --json").out);
  EXPECT_EQ(told["robot_predicted_rewards"].size(), 3u);
  EXPECT_FALSE(told.contains("rules"));
  const std::string text = Ed3r(explain + "ed3r-75/3").out;
  EXPECT_TRUE(Contains(text, "  offload    predicted reward ")) << text;
  EXPECT_TRUE(Contains(text, told["execution_by"] == "network"
                                 ? ": the best prediction among offload, full, quantized\n"
                                 : ": drawn at random from offload, full, quantized\n"))
      << text;
  EXPECT_TRUE(Contains(text, ", the RC expected ")) << text;
  const std::string fixed = Ed3r(explain + "ablation-1/3").out;
  EXPECT_TRUE(Contains(fixed, "  > full: the only execution of this strategy\n")) << fixed;
}

TEST_F(ExplainTest, AMistypedArmIsAnsweredWithTheNearest) {
  const std::string explain = "explain --step 1 " + Dir() + " ";
  ExpectRefusal(explain + "rsb/1", "rsb/1: no arm rsb; did you mean rbs?");
  ExpectRefusal(explain + "online/rsb/1", "online/rsb/1: no arm online/rsb; did you mean online/rbs?");
  ExpectRefusal(explain + "aardvark/1", "aardvark/1: no arm aardvark; the arms are online/rbs");
  ExpectRefusal(explain + "rbs", "rbs: expected ARM/NUMBER; the arms are online/rbs");
  ExpectRefusal(explain + "rsb/x", "rsb/x: expected ARM/NUMBER; the arms are online/rbs");
  ExpectRefusal(explain + "rbs/4", "rbs/4: mission numbers of rbs are 0 .. 3");
  ExpectRefusal(explain + "rbs/00", "rbs/00: mission numbers of rbs are 0 .. 3");
  for (const char* command : {"explain", "replay"})
    EXPECT_TRUE(Contains(Ed3r(fmt::format("{} --help", command)).out, "missions count from 0")) << command;
  EXPECT_TRUE(Contains(Ed3r("explain --help").out, "timesteps count from 1"));
}

TEST_F(ExplainTest, FramesAreCheckedBeforeAnythingIsWritten) {
  const ScratchFolder scratch;
  const std::string out = (scratch / "replay").string();
  for (const char* frames : {"99", "1,99", "0"}) {
    const CommandResult result =
        Ed3r(fmt::format("replay {} rbs/1 --out {} --frames {}", Dir(), out, frames));
    EXPECT_EQ(result.status, 2) << frames;
    EXPECT_TRUE(Contains(result.err, ": is not allowed; the mission has timesteps 1 .. ")) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_FALSE(fs::exists(out)) << frames;
  }
}

TEST_F(ExplainTest, FramesAreListedWithCommasOrSpaces) {
  EXPECT_TRUE(Contains(Ed3r("replay --help").out, "--frames K[,K...] "));
  const std::string mission = Dir() + " rbs/1";
  for (const std::string& arguments :
       {mission + " --frames 1,2", mission + " --frames 1 2", "--frames 1 2 " + mission}) {
    const ScratchFolder out;
    const CommandResult result = Ed3r(fmt::format("replay --out {} {}", out.Path().string(), arguments));
    EXPECT_EQ(result.status, 0) << arguments << result.err;
    EXPECT_TRUE(fs::exists(out / "step001_large.png")) << arguments;
    EXPECT_TRUE(fs::exists(out / "step002_frames.png")) << arguments;
  }
}

// The fast tier never looked at a picture: those that replay draws must not pass for what the mission knew.
TEST_F(ExplainTest, PicturesOfTheFastTierSayThatTheMissionUsedNone) {
  const ScratchFolder scratch;
  const CommandResult result =
      Ed3r(fmt::format("replay {} rbs/1 --frames 2 --out {}", Dir(), (scratch / "out").string()));
  ASSERT_EQ(result.status, 0) << result.err;
  const json step = json::parse(Ed3r("explain --json --step 2 " + Dir() + " rbs/1").out)["timestep"];
  const auto value = [&](const char* name) { return step[name].get<double>(); };
  EXPECT_TRUE(Contains(
      result.out, fmt::format("  pictures only: this mission's confidences came from the profile tier: mean "
                              "{:.3f}, sd {:.3f}, SCS {:.3f}\n",
                              value("confidence_mean"), value("confidence_sd"), value("scs"))))
      << result.out;
}

std::vector<std::string> Cells(const std::string& line) {
  std::istringstream text(line + ',');  // so that an empty last cell counts
  std::vector<std::string> cells;
  for (std::string cell; std::getline(text, cell, ',');) cells.push_back(cell);
  return cells;
}

TEST_F(ExplainTest, TimestepsAreWrittenWithTheNamesThatExplainUses) {
  const ScratchFolder scratch;
  ASSERT_EQ(Ed3r(fmt::format("replay {} rbs/1 --out {}", Dir(), (scratch / "out").string())).status, 0);
  std::istringstream lines(ReadAll(scratch / "out/timesteps.csv"));
  std::string line;
  std::getline(lines, line);
  const std::vector<std::string> columns = Cells(line);
  int rows = 0;
  for (; std::getline(lines, line) && rows < 4; ++rows) {
    const std::vector<std::string> cells = Cells(line);
    ASSERT_EQ(cells.size(), columns.size());
    std::map<std::string, std::string> row;
    for (std::size_t i = 0; i < cells.size(); ++i) row[columns[i]] = cells[i];
    const json told =
        json::parse(Ed3r(fmt::format("explain --json --step {} {} rbs/1", row["k"], Dir())).out);
    EXPECT_EQ(row["motion_rule"], told["motion_rule"]);
    EXPECT_EQ(row["execution"], told["execution"]);
    EXPECT_TRUE(told["band"].get<std::string>().starts_with(row["band"] + ":")) << row["band"];
    EXPECT_EQ(row["halted"], fmt::format("{}", told["timestep"]["halted"].get<int>()));
  }
  EXPECT_GT(rows, 1);
}

// As another C library would have flown it: candidates of this flight would stand beside numbers of that one.
TEST_F(ExplainTest, AMissionThatIsFlownOtherwiseIsNotExplained) {
  const ScratchFolder own;
  const std::string dir = (own / "run").string();
  fs::copy(Dir(), dir, fs::copy_options::recursive);
  {
    store::ResultReader reader(dir);
    mission::MissionRecord record = reader.LoadMission({0, 0, 2}).record;
    record.steps.back().reward += 1e-9;
    const auto stored = store::ResultStore::Open(dir, reader.StoredRecipe(), reader.Layout());
    stored->Remove({{.run = 0, .mission = 2, .name = "", .what = ""}});
    stored->Put({0, 0, 2}, record, 0);
    stored->Commit();
  }
  EXPECT_EQ(Ed3r("verify " + dir).status, 0);
  ExpectRefusal(fmt::format("explain {} rbs/2 --step 1", dir),
                fmt::format("rbs/2: flown again it is not the stored mission, which other code or another C "
                            "library flew: there is nothing to explain; 'ed3r replay {} rbs/2' tells more",
                            dir));
  EXPECT_EQ(Ed3r(fmt::format("replay {} rbs/2 --out {}", dir, (own / "again").string())).status, 1);
}

}  // namespace
}  // namespace ed3r::app
