#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "engine/app/commands.h"
#include "engine/app/settings.h"
#include "engine/perception/vision/frame_detector.h"
#include "studies/detection/frame_set.h"
#include "studies/detection/scores.h"

namespace ed3r {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::string path;
  std::vector<std::string> settings;
  bool json = false;
};

struct Confidences {
  std::vector<double> full, quantized;
};

Confidences Look(const DetectorPair& detectors, const FrameStack& frames) {
  const auto count = static_cast<std::size_t>(frames.frames);
  Confidences found{std::vector<double>(count), std::vector<double>(count)};
  detectors.full->Confidences(frames, found.full);
  detectors.quantized->Confidences(frames, found.quantized);
  return found;
}

Json JsonOf(const DetectionScores& s) {
  const auto number = [](double value) { return std::isnan(value) ? Json(nullptr) : Json(value); };
  return {{"auc", number(s.auc)},
          {"accuracy", number(s.accuracy)},
          {"accuracy_lo", number(s.accuracy_interval.lo)},
          {"accuracy_hi", number(s.accuracy_interval.hi)},
          {"calibration_error", number(s.calibration_error)},
          {"true_positives", s.true_positives},
          {"false_negatives", s.false_negatives},
          {"false_positives", s.false_positives},
          {"true_negatives", s.true_negatives}};
}

std::string Row(const DetectionScores& s) {
  return fmt::format("{:>6.3f} {:>6.1f} ({:>5.1f}-{:>5.1f}) {:>5} {:>5} {:>5} {:>5} {:>6.3f}", s.auc,
                     100 * s.accuracy, 100 * s.accuracy_interval.lo, 100 * s.accuracy_interval.hi,
                     s.true_positives, s.false_negatives, s.false_positives, s.true_negatives,
                     s.calibration_error);
}

int Evaluate(const Options& options, const DetectorPair& detectors) {
  const FrameSet set = ReadFrameSet(options.path);
  const Confidences found = Look(detectors, set.frames);
  const std::vector<std::pair<std::string, std::vector<Group>>> tables = {
      {"all", {All(set.labels)}},
      {"world", ByWorld(set.labels)},
      {"distance", ByDistance(set.labels)},
      {"occlusion", ByOcclusion(set.labels)},
      {"size", BySize(set.labels)}};
  Json json;
  if (!options.json)
    fmt::print(
        "{} frames; positives of a band are compared with all negatives; 'fire' is said from confidence {} "
        "on\n"
        "\n{:<20} {:<9} {:>6} {:>6} {:^13} {:>5} {:>5} {:>5} {:>5} {:>6}\n",
        set.frames.frames, kDecision, "", "", "AUC", "acc %", "(95 %)", "TP", "FN", "FP", "TN", "ECE");
  for (const auto& [title, groups] : tables)
    for (const Group& group : groups) {
      const DetectionScores full = ScoresOf(found.full, set.labels, group.frames);
      const DetectionScores quantized = ScoresOf(found.quantized, set.labels, group.frames);
      json[title][group.name] = {
          {"frames", full.Frames()}, {"full", JsonOf(full)}, {"quantized", JsonOf(quantized)}};
      if (options.json) continue;
      fmt::print("{:<20} {:<9} {}\n", group.name, "Full", Row(full));
      fmt::print("{:<20} {:<9} {}\n", "", "Quantized", Row(quantized));
    }
  if (options.json) fmt::print("{}\n", json.dump(2));
  return kDone;
}

int LookAtPictures(const Options& options, const DetectorPair& detectors) {
  const std::vector<NamedPicture> pictures = ReadPictures(options.path);
  Json json;
  if (!options.json) fmt::print("{:<40} {:>9} {:>9}\n", "confidence of fire or smoke", "Full", "Quantized");
  for (const NamedPicture& picture : pictures) {
    const Confidences found = Look(detectors, picture.frame);
    json[picture.name] = {{"full", found.full[0]}, {"quantized", found.quantized[0]}};
    if (!options.json)
      fmt::print("{:<40} {:>9.3f} {:>9.3f}\n", picture.name, found.full[0], found.quantized[0]);
  }
  if (options.json) fmt::print("{}\n", json.dump(2));
  return kDone;
}

int Detect(const Options& options) {
  Config config;
  ApplySettings(options.settings, Scope::kMission, config);
  const DetectorPair detectors = LoadDetectors(config.perception.detector);
  return IsFrameSet(options.path) ? Evaluate(options, detectors) : LookAtPictures(options, detectors);
}

}  // namespace

Command AddDetect(CLI::App& program) {
  auto options = std::make_shared<Options>();
  CLI::App* parser = program.add_subcommand("detect",
                                            "What the detectors say of a data set of 'ed3r frames' (scores "
                                            "by distance and occlusion) or of pictures");
  parser->add_option("PATH", options->path, "Folder of 'ed3r frames', folder of pictures, or one picture")
      ->required();
  parser->add_option("--set", options->settings, "KEY=VALUE; e.g. perception.detector.full=mine.onnx")
      ->allow_extra_args(false);
  parser->add_flag("--json", options->json, "Print JSON");
  return {parser, [options] { return Detect(*options); }};
}

}  // namespace ed3r
