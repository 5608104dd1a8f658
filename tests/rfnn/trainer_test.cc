#include "engine/rfnn/trainer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "engine/core/check.h"
#include "engine/rfnn/score.h"
#include "tests/rfnn/toys.h"

namespace ed3r::rfnn {
namespace {

using ::ed3r::testing::kToy;
using ::ed3r::testing::MessageOf;
using ::ed3r::testing::ReadBytes;
using ::ed3r::testing::TemporaryFolder;
using ::ed3r::testing::ToyData;
using ::ed3r::testing::WriteBytes;

TrainJob Job(const DataSet& data, int epochs = 12) {
  TrainJob job;
  job.design = testing::kToy;
  job.data = &data;
  job.config.learning_rate = 3e-3;
  job.config.batch = 64;
  job.config.epochs = epochs;
  job.seed = 4;
  job.code_version = "test";
  return job;
}

void ExpectSameNetwork(const Model& a, const Model& b) {
  EXPECT_EQ(a.data().weights, b.data().weights);
  EXPECT_EQ(a.data().report.best_epoch, b.data().report.best_epoch);
  EXPECT_EQ(LossCurveCsv(a.data().report), LossCurveCsv(b.data().report));
  EXPECT_EQ(ReportJson(a.data().report), ReportJson(b.data().report));
}

TEST(TrainerTest, LearnsAKnownFunction) {
  const DataSet data = testing::ToyData(80, 50, 0.05);
  TrainJob job = Job(data, 150);
  job.config.dropout = 0.0;
  job.config.patience = 30;
  const std::optional<Model> model = Train(job);
  ASSERT_TRUE(model);
  const TrainingReport& report = model->data().report;
  EXPECT_GT(report.test.r2, 0.95);
  EXPECT_GT(report.validation.r2, 0.95);
  EXPECT_EQ(report.test.missions, 4);
  EXPECT_EQ(report.validation.missions, 8);
  EXPECT_EQ(report.train.missions, 68);
  EXPECT_LT(report.curve.back().train, 0.1 * report.curve.front().train);
}

TEST(TrainerTest, DropoutActsAndStillLearns) {
  const DataSet data = testing::ToyData(80, 50, 0.05);
  TrainJob job = Job(data, 100);
  job.config.patience = 30;
  const std::optional<Model> model = Train(job);
  ASSERT_TRUE(model);
  EXPECT_GT(model->data().report.test.r2, 0.8);
  // The curve's training loss is taken with dropout, the score without.
  EXPECT_GT(model->data().report.curve.back().train, model->data().report.train.mse);
}

TEST(TrainerTest, KeepsTheBestEpochAndStopsWhenPatienceIsOut) {
  const DataSet data = testing::ToyData(30, 30, 1.0, 0.0);  // nothing but noise
  TrainJob job = Job(data, 500);
  job.config.patience = 7;
  const std::optional<Model> model = Train(job);
  ASSERT_TRUE(model);
  const TrainingReport& report = model->data().report;
  EXPECT_TRUE(report.stopped_early);
  ASSERT_LT(report.curve.size(), 500u);
  EXPECT_EQ(static_cast<int>(report.curve.size()), report.best_epoch + 7);
  const auto best =
      std::min_element(report.curve.begin(), report.curve.end(),
                       [](const auto& a, const auto& b) { return a.validation < b.validation; });
  EXPECT_EQ(best - report.curve.begin() + 1, report.best_epoch);
  EXPECT_NEAR(report.validation.mse, best->validation, 1e-6);
  EXPECT_LT(report.test.r2, 0.2);
}

TEST(TrainerTest, MinDeltaAsksForMore) {
  const DataSet data = testing::ToyData(30, 30, 0.1);
  TrainJob job = Job(data, 60);
  job.config.patience = 3;
  job.config.min_delta = 100.0;  // out of reach after the first epoch
  const std::optional<Model> model = Train(job);
  ASSERT_TRUE(model);
  EXPECT_EQ(model->data().report.best_epoch, 1);
  EXPECT_EQ(model->data().report.curve.size(), 4u);
}

TEST(TrainerTest, IsAPureFunctionOfItsJob) {
  const DataSet data = testing::ToyData(30, 40, 0.2);
  const TrainJob job = Job(data);
  const std::optional<Model> model = Train(job), again = Train(job);
  ASSERT_TRUE(model && again);
  ExpectSameNetwork(*model, *again);
  TrainJob other = job;
  other.seed = 5;
  EXPECT_NE(Train(other)->data().weights, model->data().weights);
  other = job;
  other.config.split_seed = 2;
  EXPECT_NE(Train(other)->data().weights, model->data().weights);
  other = job;
  other.config.seeds = 5;
  other.config.seed = 77;  // which network is the first says nothing about this one
  ExpectSameNetwork(*Train(other), *model);
}

TEST(TrainerTest, ThreadsAndSimdLevelsDoNotChangeABit) {
  const DataSet data = testing::ToyData(30, 40, 0.2);
  TrainJob job = Job(data, 4);
  job.config.batch = 100;  // sub-blocks of 32 rows and a rest
  TrainControl control;
  control.level = kernels::SimdLevel::kScalar;
  const std::optional<Model> expected = Train(job, control);
  ASSERT_TRUE(expected);
  for (const kernels::SimdLevel level :
       {kernels::SimdLevel::kScalar, kernels::SimdLevel::kAvx2, kernels::SimdLevel::kAvx512}) {
    if (!kernels::SimdLevelSupported(level)) continue;
    for (const int threads : {1, 2, 4}) {
      control.level = level;
      control.threads = threads;
      SCOPED_TRACE(std::string(kernels::SimdLevelName(level)) + " x " + std::to_string(threads));
      const std::optional<Model> found = Train(job, control);
      ASSERT_TRUE(found);
      ExpectSameNetwork(*found, *expected);
    }
  }
}

class ResumeTest : public ::testing::Test {
 protected:
  ResumeTest() : data_(testing::ToyData(30, 40, 0.2)), job_(Job(data_)), expected_(Train(job_)) {
    control_.checkpoint = folder_.File("checkpoint");
    control_.stop = &stop_;
  }

  // Trains until `epoch` is done.
  void StopAfter(int epoch) {
    control_.on_epoch = [this, epoch](int done, const EpochLoss&) { stop_ = done >= epoch; };
    EXPECT_FALSE(Train(job_, control_));
    stop_ = false;
    control_.on_epoch = nullptr;
  }

  testing::TemporaryFolder folder_;
  DataSet data_;
  TrainJob job_;
  std::optional<Model> expected_;
  std::atomic<bool> stop_ = false;
  TrainControl control_;
};

TEST_F(ResumeTest, InterruptedTrainingsEndInTheSameBits) {
  StopAfter(1);
  StopAfter(5);
  StopAfter(11);
  int epochs = 0;
  control_.on_epoch = [&](int, const EpochLoss&) { ++epochs; };
  const std::optional<Model> model = Train(job_, control_);
  ASSERT_TRUE(model);
  EXPECT_EQ(epochs, 1);
  ExpectSameNetwork(*model, *expected_);
}

TEST_F(ResumeTest, AKilledTrainingGoesOnFromItsLastPeriodicCheckpoint) {
  control_.checkpoint_epochs = 4;
  struct Kill {};
  control_.on_epoch = [](int done, const EpochLoss&) {
    if (done == 7) throw Kill();
  };
  EXPECT_THROW(Train(job_, control_), Kill);
  int first = 0;
  control_.on_epoch = [&](int epoch, const EpochLoss&) { first = first ? first : epoch; };
  const std::optional<Model> model = Train(job_, control_);
  ASSERT_TRUE(model);
  EXPECT_EQ(first, 5);
  ExpectSameNetwork(*model, *expected_);
}

TEST_F(ResumeTest, StoppingBeforeTheFirstEpochLeavesNothing) {
  stop_ = true;
  EXPECT_FALSE(Train(job_, control_));
  EXPECT_FALSE(std::filesystem::exists(control_.checkpoint));
}

TEST_F(ResumeTest, CheckpointsOfOtherTrainingsAreRefused) {
  StopAfter(3);
  job_.config.learning_rate = 2e-3;
  EXPECT_EQ(testing::MessageOf<UserError>([&] { Train(job_, control_); }),
            control_.checkpoint +
                ": this training checkpoint belongs to another training; delete it to start anew");
}

TEST_F(ResumeTest, DamagedCheckpointsAreRefused) {
  StopAfter(3);
  std::string bytes = testing::ReadBytes(control_.checkpoint);
  bytes[bytes.size() / 2] ^= 1;
  testing::WriteBytes(control_.checkpoint, bytes);
  EXPECT_EQ(
      testing::MessageOf<UserError>([&] { Train(job_, control_); }),
      control_.checkpoint + ": this training checkpoint is damaged: its SHA-256 does not match its content");
}

TEST(TrainerTest, DivergenceIsAUserError) {
  const DataSet data = testing::ToyData(10, 20, 0.2);
  TrainJob job = Job(data);
  job.config.learning_rate = 1e30;
  EXPECT_EQ(testing::MessageOf<UserError>([&] { Train(job); }),
            "training.learning_rate: '1e+30' makes the toy network diverge: no finite validation error in 10 "
            "epochs");
}

TEST(TrainerTest, ProvenanceTellsWhereItComesFrom) {
  const DataSet data = testing::ToyData(10, 20, 0.2);
  TrainJob job = Job(data, 1);
  job.notes = {{"eta_min", "0.75"}};
  const std::optional<Model> model = Train(job);
  ASSERT_TRUE(model);
  const Provenance expected = {{"design", "toy"},
                               {"data_sha256", Fingerprint(data)},
                               {"seed", "4"},
                               {"code", "test"},
                               {"training.learning_rate", "0.003"},
                               {"training.batch", "64"},
                               {"training.dropout", "0.1"},
                               {"training.epochs", "1"},
                               {"training.patience", "10"},
                               {"training.min_delta", "0"},
                               {"training.split_seed", "1"},
                               {"eta_min", "0.75"}};
  EXPECT_EQ(model->data().provenance, expected);
}

TEST(TrainingKeyTest, IsOfContentAndNothingElse) {
  const DataSet data = testing::ToyData(10, 20, 0.2), other_data = testing::ToyData(10, 20, 0.3);
  const TrainJob job = Job(data);
  std::set<std::string> keys = {TrainingKey(job)};
  const auto differs = [&](auto change) {
    TrainJob other = job;
    change(other);
    return keys.insert(TrainingKey(other)).second;
  };
  EXPECT_TRUE(differs([&](TrainJob& j) { j.data = &other_data; }));
  EXPECT_TRUE(differs([](TrainJob& j) { j.seed = 5; }));
  EXPECT_TRUE(differs([](TrainJob& j) { j.code_version = "next"; }));
  EXPECT_TRUE(differs([](TrainJob& j) { j.config.patience = 11; }));
  EXPECT_TRUE(differs([](TrainJob& j) { j.design.states = 2; }));
  EXPECT_FALSE(differs([](TrainJob& j) { j.notes = {{"sweep", "another"}}; }));
  EXPECT_FALSE(differs([](TrainJob& j) { j.config.seeds = 9; }));
}

}  // namespace
}  // namespace ed3r::rfnn
