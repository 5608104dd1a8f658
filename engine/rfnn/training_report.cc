#include "engine/rfnn/training_report.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace ed3r::rfnn {
namespace {

nlohmann::ordered_json ScoreJson(const FitScore& score) {
  return {{"rows", score.rows}, {"missions", score.missions}, {"mse", score.mse},
          {"r2", score.r2},     {"mae", score.mae},           {"rmse", score.rmse}};
}

}  // namespace

std::string LossCurveCsv(const TrainingReport& report) {
  std::string text = "epoch,train_mse,validation_mse\n";
  int epoch = 0;
  for (const EpochLoss& loss : report.curve)
    text += fmt::format("{},{},{}\n", ++epoch, loss.train, loss.validation);
  return text;
}

std::string ReportJson(const TrainingReport& report) {
  std::vector<double> train, validation;
  for (const EpochLoss& loss : report.curve) {
    train.push_back(loss.train);
    validation.push_back(loss.validation);
  }
  const nlohmann::ordered_json json = {{"epochs", report.curve.size()},
                                       {"best_epoch", report.best_epoch},
                                       {"stopped_early", report.stopped_early},
                                       {"train", ScoreJson(report.train)},
                                       {"validation", ScoreJson(report.validation)},
                                       {"test", ScoreJson(report.test)},
                                       {"curve", {{"train_mse", train}, {"validation_mse", validation}}}};
  return json.dump();
}

}  // namespace ed3r::rfnn
