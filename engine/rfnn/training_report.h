// How a training went: its loss curve, and the error of the network that it left behind.
#pragma once

#include <string>
#include <vector>

namespace ed3r::rfnn {

// Mean squared errors of standardised rewards: 1 is what always predicting the mean reward gives.
struct EpochLoss {
  double train = 0.0;       // mean over the epoch's steps: with dropout, while the weights moved
  double validation = 0.0;  // after the epoch, without dropout
};

// The fit on one part of the split.
struct FitScore {
  int rows = 0;
  int missions = 0;
  double mse = 0.0;   // standardised
  double r2 = 0.0;    // 1 - SSE / SST about the part's own mean; NaN where its rewards are all equal
  double mae = 0.0;   // in units of reward
  double rmse = 0.0;  // in units of reward
};

struct TrainingReport {
  std::vector<EpochLoss> curve;  // one entry per epoch
  int best_epoch = 0;            // 1-based: the epoch whose weights were kept
  bool stopped_early = false;    // by patience, not by the number of epochs
  FitScore train, validation, test;
};

// "epoch,train_mse,validation_mse" and one line per epoch. Numbers read back to the same bits.
std::string LossCurveCsv(const TrainingReport& report);

// {"epochs", "best_epoch", "stopped_early", "train": {...}, "validation": {...}, "test": {...},
//  "curve": {"train_mse": [...], "validation_mse": [...]}}; NaN becomes null.
std::string ReportJson(const TrainingReport& report);

}  // namespace ed3r::rfnn
