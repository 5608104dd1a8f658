// The plan's canonical text is the identity of its results: it must tell different studies apart, and be the
// same wherever the files lie and however the command names them.
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <set>

#include "engine/core/files/shipped.h"
#include "tests/sweep/scratch.h"

namespace ed3r::sweep {
namespace {

namespace fs = std::filesystem;

// Enters a folder for the length of a scope.
class WorkingIn {
 public:
  explicit WorkingIn(const std::string& folder) : before_(fs::current_path()) { fs::current_path(folder); }
  ~WorkingIn() { fs::current_path(before_); }
  WorkingIn(const WorkingIn&) = delete;
  WorkingIn& operator=(const WorkingIn&) = delete;

 private:
  fs::path before_;
};

// A study of three worlds: one of its own, one of a base file elsewhere, and the default.
std::string WriteStudy(const ScratchFolder& scratch, const std::string& folder) {
  scratch.Write(folder + "/sweeps/worlds/a.yaml", "a");
  scratch.Write(folder + "/common/worlds/b.yaml", "b");
  scratch.Write(folder + "/common/base.yaml",
                "missions: 3\nset: {mission.world: worlds/b.yaml}\nstages:\n  - {name: based}\n");
  return scratch.Write(folder + "/sweeps/x.yaml",
                       "name: x\nbase: ../common/base.yaml\nstages:\n"
                       "  - {name: based}\n"
                       "  - {name: own, set: {mission.world: ./worlds/../worlds/a.yaml}}\n");
}

TEST(IdentityTest, DoesNotDependOnWhereTheTreeLies) {
  const ScratchFolder scratch;
  const std::string here = WriteStudy(scratch, "here");
  const std::string there = WriteStudy(scratch, "far/away/there");
  const SweepPlan plan = LoadSweep(here);
  const std::string text = plan.CanonicalText();
  EXPECT_NE(text.find("\nmission.world=../common/worlds/b.yaml\n"), std::string::npos) << text;
  EXPECT_NE(text.find("\nmission.world=worlds/a.yaml\n"), std::string::npos) << text;
  EXPECT_EQ(text.find(scratch.Path()), std::string::npos);
  EXPECT_EQ(LoadSweep(there).CanonicalText(), text);
  EXPECT_EQ(plan.stages[0].arms[0].config.mission.world, scratch.Path() + "/here/common/worlds/b.yaml");
  EXPECT_EQ(plan.stages[1].arms[0].config.mission.world, scratch.Path() + "/here/sweeps/worlds/a.yaml");
}

TEST(IdentityTest, DoesNotDependOnHowTheFileIsNamed) {
  const ScratchFolder scratch;
  const std::string text = LoadSweep(WriteStudy(scratch, "here")).CanonicalText();
  for (const auto& [folder, file] : {std::pair{"here", "sweeps/x.yaml"},
                                     {"here/sweeps", "x.yaml"},
                                     {"here/sweeps/worlds", "../x.yaml"},
                                     {"here/sweeps", "./../sweeps/x.yaml"},
                                     {"here/common/worlds", "../../sweeps/x.yaml"}}) {
    const WorkingIn working(scratch.Path() + "/" + folder);
    const SweepPlan plan = LoadSweep(file);
    EXPECT_EQ(plan.CanonicalText(), text) << file;
    for (const Stage& stage : plan.stages)
      EXPECT_TRUE(fs::is_regular_file(stage.arms[0].config.mission.world)) << file;
  }
}

TEST(IdentityTest, WorldAfterSetIsRelativeToThePresentFolder) {
  const ScratchFolder scratch;
  const std::string file =
      scratch.Write("sweeps/x.yaml", "name: x\nmissions: 1\nset: {mission.world: worlds/a.yaml}\n");
  scratch.Write("sweeps/worlds/a.yaml", "a");
  const std::string text = LoadSweep(file).CanonicalText();
  const WorkingIn working(scratch.Path());
  const SweepPlan plan = LoadSweep("sweeps/x.yaml", {{"mission.world=sweeps/worlds/a.yaml"}, {}, {}});
  EXPECT_EQ(plan.CanonicalText(), text);
  EXPECT_EQ(plan.stages[0].arms[0].config.mission.world, "sweeps/worlds/a.yaml");
}

TEST(IdentityTest, DetectorsAreRelativeToTheSweepFile) {
  const ScratchFolder scratch;
  const std::string study =
      "name: x\nmissions: 1\nset: {mission.world: w.yaml, perception.detector.full: nets/a.onnx}\n";
  for (const char* folder : {"here", "far/away"}) {
    scratch.Write(std::string(folder) + "/w.yaml", "w");
    scratch.Write(std::string(folder) + "/nets/a.onnx", "a");
    const SweepPlan plan = LoadSweep(scratch.Write(std::string(folder) + "/x.yaml", study));
    const std::string text = plan.CanonicalText();
    EXPECT_NE(text.find("\nperception.detector.full=nets/a.onnx\n"), std::string::npos) << text;
    EXPECT_NE(text.find("\nperception.detector.quantized=builtin\n"), std::string::npos) << text;
    EXPECT_EQ(plan.stages[0].arms[0].config.perception.detector.full,
              scratch.Path() + "/" + folder + "/nets/a.onnx");
    EXPECT_EQ(plan.stages[0].arms[0].config.perception.detector.quantized, "builtin");
  }
}

TEST(IdentityTest, ADetectorThatIsNoFileIsRefusedBeforeAnythingElse) {
  const ScratchFolder scratch;
  scratch.Write("w.yaml", "w");
  const std::string file = scratch.Write(
      "x.yaml", "name: x\nmissions: 1\nset: {mission.world: w.yaml, perception.detector.full: a.onnx}\n");
  try {
    LoadSweep(file);
    FAIL() << "a detector that does not exist was accepted";
  } catch (const UserError& error) {
    const std::string said = error.what();
    EXPECT_NE(said.find("x.yaml:3:"), std::string::npos) << said;
    EXPECT_NE(said.find("perception.detector.full: 'a.onnx' is not a file"), std::string::npos) << said;
    EXPECT_NE(said.find("'builtin' is allowed too"), std::string::npos) << said;
  }
}

TEST(IdentityTest, OnlyADetectorMayBeBuiltIn) {
  const std::string said = Refusal("name: x\nmissions: 1\nset: {mission.world: builtin}\n");
  EXPECT_NE(said.find("mission.world: 'builtin' is not a file"), std::string::npos) << said;
  EXPECT_EQ(said.find("allowed too"), std::string::npos) << said;
}

TEST(IdentityTest, FilesOnAnAxisGiveTheirStemsToTheArms) {
  const ScratchFolder scratch;
  for (const char* file : {"w.yaml", "nets/a.onnx", "nets/b@2.onnx"}) scratch.Write(file, "");
  const SweepPlan plan =
      LoadSweep(scratch.Write("x.yaml",
                              "name: x\nmissions: 1\nset: {mission.world: w.yaml, strategy: rbs}\n"
                              "sweep: {perception.detector.full: [builtin, nets/a.onnx, nets/b@2.onnx]}\n"));
  EXPECT_EQ(ArmNames(plan.stages[0]),
            (std::vector<std::string>{"rbs,full=builtin", "rbs,full=a", "rbs,full=b_2"}));
}

TEST(IdentityTest, AbsoluteWorldsStayAbsolute) {
  const ScratchFolder scratch;
  const std::string world = scratch.Write("elsewhere/w.yaml", "w");
  const std::string study = "name: x\nmissions: 1\nset: {mission.world: " + world + "}\n";
  const std::string text = LoadSweep(scratch.Write("x.yaml", study)).CanonicalText();
  EXPECT_NE(text.find("\nmission.world=" + world + "\n"), std::string::npos);
  EXPECT_EQ(LoadSweep(scratch.Write("deep/er/x.yaml", study)).CanonicalText(), text);
}

// The shipped one where none lies beside the sweep file; the study is the same.
TEST(IdentityTest, DefaultWorldIsBesideTheSweepFileOrShipped) {
  const ScratchFolder scratch;
  const std::string study = scratch.Write("a/x.yaml", "name: x\nmissions: 1\n");
  const SweepPlan elsewhere = LoadSweep(study);
  EXPECT_EQ(elsewhere.stages[0].arms[0].config.mission.world,
            (ShippedSweeps() / "worlds/paper.yaml").string());
  EXPECT_NE(elsewhere.CanonicalText().find("\nmission.world=worlds/paper.yaml\n"), std::string::npos);
  const std::string world = scratch.Write("a/worlds/paper.yaml", "w");
  const SweepPlan beside = LoadSweep(study);
  EXPECT_EQ(beside.stages[0].arms[0].config.mission.world, world);
  EXPECT_EQ(beside.CanonicalText(), elsewhere.CanonicalText());
}

TEST(IdentityTest, DoesNotDependOnHowTheSameStudyIsWritten) {
  const std::string text = LoadText("name: x\nmissions: 2\nsweep: {robot.mass_kg: [1, 2]}\n").CanonicalText();
  EXPECT_EQ(LoadText("# Other words\nmissions: 2\nsweep:\n  robot.mass_kg: {range: [1.0, 2.0, 1]}\n"
                     "seed: 0\nname: 'x'\nset: {robot.speed_mps: 5.000}\n")
                .CanonicalText(),
            text);
}

TEST(IdentityTest, TellsDifferentStudiesApart) {
  const std::vector<std::string> studies = {
      "name: x\nmissions: 2\n",
      "name: y\nmissions: 2\n",
      "name: x\nmissions: 3\n",
      "name: x\nmissions: 2\nseed: 1\n",
      "name: x\nmissions: 2\nset: {robot.mass_kg: 1.8160000000000001}\n",
      "name: x\nmissions: 2\nset: {robot.mass_kg: 1.8160000000000003}\n",
      "name: x\nmissions: 2\nsweep: {robot.mass_kg: [1, 2]}\n",
      "name: x\nmissions: 2\nsweep: {robot.mass_kg: [2, 1]}\n",
      "name: x\nmissions: 2\nstages: [{name: a}, {name: b}]\n",
      "name: x\nmissions: 2\nstages: [{name: a}, {name: b, after: a}]\n",
      "name: x\nmissions: 2\nstages: [{name: a}, {name: b, kind: train}]\n",
  };
  std::set<std::string> texts;
  for (const std::string& study : studies) texts.insert(LoadText(study).CanonicalText());
  EXPECT_EQ(texts.size(), studies.size() - 1);  // 1.8160000000000001 reads to the default, 1.816
}

}  // namespace
}  // namespace ed3r::sweep
