#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "engine/app/commands.h"
#include "engine/app/settings.h"
#include "engine/perception/vision/frame_detector.h"
#include "studies/detection/difference.h"
#include "studies/detection/frame_set.h"
#include "studies/detection/scores.h"
#include "studies/metrics/number_text.h"

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
  return {{"auc", JsonNumber(s.auc)},
          {"accuracy", JsonNumber(s.accuracy)},
          {"accuracy_lo", JsonNumber(s.accuracy_interval.lo)},
          {"accuracy_hi", JsonNumber(s.accuracy_interval.hi)},
          {"calibration_error", JsonNumber(s.calibration_error)},
          {"true_positives", s.true_positives},
          {"false_negatives", s.false_negatives},
          {"false_positives", s.false_positives},
          {"true_negatives", s.true_negatives}};
}

Json JsonOf(const Difference& d) {
  return {
      {"mean", JsonNumber(d.value)}, {"lo", JsonNumber(d.interval.lo)}, {"hi", JsonNumber(d.interval.hi)}};
}

Json JsonOf(const DetectorDifference& d) {
  return {{"auc", JsonOf(d.auc)},
          {"accuracy", JsonOf(d.accuracy)},
          {"cross_entropy", JsonOf(d.cross_entropy)},
          {"views", d.views},
          {"views_decided_differently", d.decided_differently}};
}

std::string Row(const DetectionScores& s) {
  return fmt::format("{:>6.3f} {:>6.1f} ({:>5.1f}-{:>5.1f}) {:>5} {:>5} {:>5} {:>5} {:>6.3f}", s.auc,
                     100 * s.accuracy, 100 * s.accuracy_interval.lo, 100 * s.accuracy_interval.hi,
                     s.true_positives, s.false_negatives, s.false_positives, s.true_negatives,
                     s.calibration_error);
}

enum class Better { kMore, kLess };

// "-0.0006 (-0.0015 to 0.0002): not distinguishable": a difference in units of 1 / scale.
std::string InWords(const Difference& d, double scale, int digits, const std::string& unit, Better better) {
  if (std::isnan(d.value)) return "none: it takes frames with and without fire";
  const std::string value = fmt::format("{:7.{}f}{}", scale * d.value, digits, unit);
  if (!d.interval.Exists()) return value + ": too few views for an interval";
  const char* meaning = "not distinguishable";
  if (d.Distinguishable())
    meaning = (d.value > 0.0) == (better == Better::kMore) ? "Quantized is better" : "Quantized is worse";
  return fmt::format("{} ({:.{}f} to {:.{}f}): {}", value, scale * d.interval.lo, digits,
                     scale * d.interval.hi, digits, meaning);
}

void Print(const DetectorDifference& d) {
  const bool few = d.accuracy.interval.Exists() && d.decided_differently < kFewDecidedDifferently;
  fmt::print(
      "\nQuantized minus Full, same frames (95 %, views drawn again):\n"
      "  AUC           {}\n  accuracy      {}\n  cross-entropy {}\n"
      "They decide differently in {} of {} views{}.\n",
      InWords(d.auc, 1.0, 4, "", Better::kMore), InWords(d.accuracy, 100.0, 2, " points", Better::kMore),
      InWords(d.cross_entropy, 1.0, 4, "", Better::kLess), d.decided_differently, d.views,
      few ? ", so few that the interval of the accuracy may be too narrow" : "");
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
  const auto compare = [&](const Group& group, int resamples) {
    return SecondMinusFirst(found.full, found.quantized, set.labels, group.frames, resamples);
  };
  const DetectorDifference difference = compare(All(set.labels), kManyResamples);
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
      if (options.json) {
        json[title][group.name] = {{"frames", full.Frames()},
                                   {"full", JsonOf(full)},
                                   {"quantized", JsonOf(quantized)},
                                   {"difference", JsonOf(compare(group, kSomeResamples))}};
        continue;
      }
      fmt::print("{:<20} {:<9} {}\n", group.name, "Full", Row(full));
      fmt::print("{:<20} {:<9} {}\n", "", "Quantized", Row(quantized));
    }
  if (options.json) {
    json["difference"] = json["all"]["all"]["difference"] = JsonOf(difference);
    fmt::print("{}\n", json.dump(2));
  } else {
    Print(difference);
  }
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

Command AddDetect(Program& program) {
  auto options = std::make_shared<Options>();
  CommandLine parser = program.AddCommand("detect",
                                          "What the detectors say of a data set of 'ed3r frames' (scores "
                                          "by distance and occlusion) or of pictures");
  parser.Option("PATH", options->path, "Folder of 'ed3r frames', folder of pictures, or one picture")
      .Required();
  parser.Option("--set", options->settings, "KEY=VALUE; e.g. perception.detector.full=mine.onnx").OneValue();
  parser.Flag("--json", options->json, "Print JSON");
  return {parser, [options] { return Detect(*options); }};
}

}  // namespace ed3r
