#include "engine/rfnn/train_all.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "engine/core/check.h"
#include "tests/rfnn/toys.h"

namespace ed3r::rfnn {
namespace {

using ::ed3r::testing::kToy;
using ::ed3r::testing::MessageOf;
using ::ed3r::testing::TemporaryFolder;
using ::ed3r::testing::ToyData;
using ::ed3r::testing::WriteBytes;

class TrainAllTest : public ::testing::Test {
 protected:
  TrainAllTest() : data_(testing::ToyData(20, 30, 0.2)) {
    options_.cache = folder_.File("cache/networks");
    options_.on_epoch = [this](std::size_t, int, const EpochLoss&) { ++epochs_; };
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      TrainJob job;
      job.design = testing::kToy;
      job.data = &data_;
      job.config.learning_rate = 3e-3;
      job.config.batch = 64;
      job.config.epochs = 5;
      job.seed = seed;
      jobs_.push_back(job);
    }
  }

  int Files() const {
    int files = 0;
    for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(options_.cache)) ++files;
    return files;
  }

  testing::TemporaryFolder folder_;
  DataSet data_;
  std::vector<TrainJob> jobs_;
  TrainAllOptions options_;
  int epochs_ = 0;
};

TEST_F(TrainAllTest, NumberOfThreadsAndCacheDoNotChangeABit) {
  options_.threads = 3;
  const auto parallel = TrainAll(jobs_, options_);
  EXPECT_EQ(epochs_, 20);
  TrainAllOptions plain;
  const auto serial = TrainAll(jobs_, plain);
  const auto cached = TrainAll(jobs_, options_);
  EXPECT_EQ(epochs_, 20);  // nothing was trained again
  EXPECT_EQ(Files(), 4);   // no checkpoint is left
  for (std::size_t i = 0; i < jobs_.size(); ++i) {
    ASSERT_TRUE(parallel[i] && serial[i] && cached[i]);
    EXPECT_EQ(parallel[i]->data().weights, serial[i]->data().weights);
    EXPECT_EQ(cached[i]->data().weights, serial[i]->data().weights);
    EXPECT_EQ(ReportJson(cached[i]->data().report), ReportJson(serial[i]->data().report));
    EXPECT_EQ(serial[i]->data().weights, Train(jobs_[i])->data().weights);
  }
}

TEST_F(TrainAllTest, AValidNetworkInAnothersPlaceIsRefused) {
  TrainAll(jobs_, options_);
  const std::string first = CachePath(options_.cache, jobs_[0]), second = CachePath(options_.cache, jobs_[1]);
  std::filesystem::rename(first, folder_.File("kept"));
  std::filesystem::rename(second, first);
  std::filesystem::rename(folder_.File("kept"), second);
  EXPECT_EQ(testing::MessageOf<UserError>([&] { TrainAll(jobs_, options_); }),
            fmt::format(
                "{}: this model file holds the network of another training ({:.16}; wanted: {:.16}); delete "
                "it to train anew",
                first, TrainingKey(jobs_[1]), TrainingKey(jobs_[0])));
  std::filesystem::remove(first);
  std::filesystem::remove(second);
  EXPECT_EQ(TrainAll(jobs_, options_)[0]->data().weights, Train(jobs_[0])->data().weights);
}

TEST_F(TrainAllTest, EqualJobsShareOneNetwork) {
  jobs_ = {jobs_[0], jobs_[1], jobs_[0]};
  jobs_[2].notes = {{"arm", "ablation-1"}};
  options_.threads = 2;
  const auto models = TrainAll(jobs_, options_);
  EXPECT_EQ(models[0], models[2]);
  EXPECT_NE(models[0], models[1]);
  EXPECT_EQ(epochs_, 10);
}

TEST_F(TrainAllTest, StoppedTrainingsGoOn) {
  std::atomic<bool> stop = false;
  options_.stop = &stop;
  options_.on_epoch = [&](std::size_t, int, const EpochLoss&) { stop = ++epochs_ == 7; };
  const auto first = TrainAll(jobs_, options_);  // one thread: job 0 done, job 1 after its 2nd epoch
  EXPECT_TRUE(first[0]);
  EXPECT_FALSE(first[1] || first[2] || first[3]);
  stop = false;
  const auto second = TrainAll(jobs_, options_);
  EXPECT_EQ(epochs_, 20);
  for (std::size_t i = 0; i < jobs_.size(); ++i) {
    ASSERT_TRUE(second[i]);
    EXPECT_EQ(second[i]->data().weights, Train(jobs_[i])->data().weights);
  }
}

TEST_F(TrainAllTest, ADamagedNetworkInTheCacheIsRefusedAfterTheOthersAreDone) {
  TrainAll(std::span(jobs_).first(1), options_);
  const std::string path = CachePath(options_.cache, jobs_[0]);
  ASSERT_TRUE(std::filesystem::exists(path));
  testing::WriteBytes(path, "no network");
  EXPECT_EQ(testing::MessageOf<UserError>([&] { TrainAll(jobs_, options_); }),
            path + ": is not a model file");
  EXPECT_EQ(epochs_, 20);
  EXPECT_EQ(Files(), 4);
}

TEST_F(TrainAllTest, ACacheThatCannotBeMadeIsAUserError) {
  testing::WriteBytes(folder_.File("file"), "");
  options_.cache = folder_.File("file");
  EXPECT_TRUE(testing::MessageOf<UserError>([&] {
                TrainAll(jobs_, options_);
              }).starts_with(options_.cache + ": cannot make this folder for networks: "));
}

}  // namespace
}  // namespace ed3r::rfnn
