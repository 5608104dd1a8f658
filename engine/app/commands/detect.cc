#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

#include "engine/app/commands.h"
#include "engine/app/settings.h"
#include "engine/app/words.h"
#include "engine/core/check.h"
#include "engine/core/files/file.h"
#include "engine/core/json_text.h"
#include "engine/core/message.h"
#include "engine/perception/vision/frame_detector.h"
#include "studies/detection/difference.h"
#include "studies/detection/frame_set.h"
#include "studies/detection/scores.h"
#include "studies/metrics/number_text.h"

namespace ed3r::app {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::string path, table;
  std::vector<std::string> settings;
  bool json = false;
};

struct Confidences {
  std::vector<double> full, quantized;
};

Confidences Look(const perception::DetectorPair& detectors, const perception::FrameStack& frames) {
  const auto count = static_cast<std::size_t>(frames.frames);
  Confidences found{std::vector<double>(count), std::vector<double>(count)};
  detectors.full->Confidences(frames, found.full);
  detectors.quantized->Confidences(frames, found.quantized);
  return found;
}

// Of a recording a part at a time, so that it is in memory once.
Confidences Look(const perception::DetectorPair& detectors, const detection::NpyFrames& frames) {
  constexpr std::int64_t kPartBytes = 16 << 20;
  const std::int64_t frame_bytes = std::int64_t{3} * frames.width_px() * frames.height_px();
  const int at_once = static_cast<int>(std::max(std::int64_t{1}, kPartBytes / frame_bytes));
  Confidences found;
  for (int first = 0; first < frames.frames(); first += at_once) {
    const Confidences some = Look(detectors, frames.Some(first, std::min(at_once, frames.frames() - first)));
    found.full.insert(found.full.end(), some.full.begin(), some.full.end());
    found.quantized.insert(found.quantized.end(), some.quantized.begin(), some.quantized.end());
  }
  return found;
}

Json JsonOf(const detection::DetectionScores& s) {
  return {{"auc", metrics::JsonNumber(s.auc)},
          {"accuracy", metrics::JsonNumber(s.accuracy)},
          {"accuracy_lo", metrics::JsonNumber(s.accuracy_interval.lo)},
          {"accuracy_hi", metrics::JsonNumber(s.accuracy_interval.hi)},
          {"calibration_error", metrics::JsonNumber(s.calibration_error)},
          {"true_positives", s.true_positives},
          {"false_negatives", s.false_negatives},
          {"false_positives", s.false_positives},
          {"true_negatives", s.true_negatives}};
}

Json JsonOf(const detection::Difference& d) {
  return {{"mean", metrics::JsonNumber(d.value)},
          {"lo", metrics::JsonNumber(d.interval.lo)},
          {"hi", metrics::JsonNumber(d.interval.hi)}};
}

Json JsonOf(const detection::DetectorDifference& d) {
  return {{"auc", JsonOf(d.auc)},
          {"accuracy", JsonOf(d.accuracy)},
          {"cross_entropy", JsonOf(d.cross_entropy)},
          {"views", d.views},
          {"views_decided_differently", d.decided_differently}};
}

// "-" where there is none: the area under the curve takes frames with and without fire.
std::string Number(double value, int width, int digits) {
  return std::isnan(value) ? fmt::format("{:>{}}", "-", width)
                           : fmt::format("{:>{}.{}f}", value, width, digits);
}

std::string Row(const detection::DetectionScores& s) {
  return fmt::format("{} {} ({}-{}) {:>5} {:>5} {:>5} {:>5} {}", Number(s.auc, 6, 3),
                     Number(100 * s.accuracy, 6, 1), Number(100 * s.accuracy_interval.lo, 5, 1),
                     Number(100 * s.accuracy_interval.hi, 5, 1), s.true_positives, s.false_negatives,
                     s.false_positives, s.true_negatives, Number(s.calibration_error, 6, 3));
}

enum class Better { kMore, kLess };

// "-0.0006 (-0.0015 to 0.0002): not distinguishable": a difference in units of 1 / scale.
std::string InWords(const detection::Difference& d, double scale, int digits, const std::string& unit,
                    Better better) {
  if (std::isnan(d.value)) return "none: it takes frames with and without fire";
  const std::string value = fmt::format("{:7.{}f}{}", scale * d.value, digits, unit);
  if (!d.interval.Exists()) return value + ": too few views for an interval";
  const char* meaning = "not distinguishable";
  if (d.Distinguishable())
    meaning = (d.value > 0.0) == (better == Better::kMore) ? "Quantized is better" : "Quantized is worse";
  return fmt::format("{} ({:.{}f} to {:.{}f}): {}", value, scale * d.interval.lo, digits,
                     scale * d.interval.hi, digits, meaning);
}

void Print(const detection::DetectorDifference& d) {
  const bool few = d.accuracy.interval.Exists() && d.decided_differently < detection::kFewDecidedDifferently;
  fmt::print(
      "\nQuantized minus Full, same frames (95 %, views drawn again):\n"
      "  AUC           {}\n  accuracy      {}\n  cross-entropy {}\n"
      "They decide differently in {} of {} views{}.\n",
      InWords(d.auc, 1.0, 4, "", Better::kMore), InWords(d.accuracy, 100.0, 2, " points", Better::kMore),
      InWords(d.cross_entropy, 1.0, 4, "", Better::kLess), d.decided_differently, d.views,
      few ? ", so few that the interval of the accuracy may be too narrow" : "");
}

// As labels.csv has the frames, in its order.
void WriteTable(const std::string& path, const Confidences& found) {
  std::string text = "index,full,quantized\n";
  for (std::size_t i = 0; i < found.full.size(); ++i)
    text += fmt::format("{},{:.6f},{:.6f}\n", i, found.full[i], found.quantized[i]);
  WriteFile(path, text);
}

int Evaluate(const Options& options, const DetectorConfig& config,
             const perception::DetectorPair& detectors) {
  const std::filesystem::path folder(options.path);
  if (!options.table.empty())
    CheckNoInput(options.table,
                 {folder / "frames.npy", folder / "labels.csv", folder / "manifest.json", config.full,
                  config.quantized},
                 "--table");
  const detection::FrameSet set = detection::ReadFrameSet(options.path);
  const Confidences found = Look(detectors, set.frames);
  if (!options.table.empty()) WriteTable(options.table, found);
  const std::vector<std::pair<std::string, std::vector<detection::Group>>> tables = {
      {"all", {detection::All(set.labels)}},
      {"world", detection::ByWorld(set.labels)},
      {"distance", detection::ByDistance(set.labels)},
      {"occlusion", detection::ByOcclusion(set.labels)},
      {"size", detection::BySize(set.labels)}};
  const auto compare = [&](const detection::Group& group, int resamples) {
    return detection::SecondMinusFirst(found.full, found.quantized, set.labels, group.frames, resamples);
  };
  const detection::DetectorDifference difference =
      compare(detection::All(set.labels), detection::kManyResamples);
  Json json;
  if (!options.json)
    fmt::print(
        "{} frames; positives of a band are compared with all negatives; 'fire' is said from confidence {} "
        "on\n"
        "\n{:<20} {:<9} {:>6} {:>6} {:^13} {:>5} {:>5} {:>5} {:>5} {:>6}\n",
        set.frames.frames(), detection::kDecision, "", "", "AUC", "acc %", "(95 %)", "TP", "FN", "FP", "TN",
        "ECE");
  for (const auto& [title, groups] : tables)
    for (const detection::Group& group : groups) {
      const detection::DetectionScores full = detection::ScoresOf(found.full, set.labels, group.frames);
      const detection::DetectionScores quantized =
          detection::ScoresOf(found.quantized, set.labels, group.frames);
      if (options.json) {
        json[title][group.name] = {{"frames", full.Frames()},
                                   {"full", JsonOf(full)},
                                   {"quantized", JsonOf(quantized)},
                                   {"difference", JsonOf(compare(group, detection::kSomeResamples))}};
        continue;
      }
      fmt::print("{:<20} {:<9} {}\n", group.name, "Full", Row(full));
      fmt::print("{:<20} {:<9} {}\n", "", "Quantized", Row(quantized));
    }
  if (options.json) {
    json["difference"] = json["all"]["all"]["difference"] = JsonOf(difference);
    fmt::print("{}\n", JsonText(json));
  } else {
    Print(difference);
  }
  return kDone;
}

// One picture's row, or the reason why there is none.
class PictureTable {
 public:
  explicit PictureTable(bool json) : in_json_(json) {
    if (!json) fmt::print("{:<40} {:>9} {:>9}\n", "confidence of fire or smoke", "Full", "Quantized");
  }

  void Add(const detection::NamedPicture& picture, const Confidences& found) {
    ++read_;
    if (in_json_) {
      json_[picture.name] = {{"full", found.full[0]}, {"quantized", found.quantized[0]}};
      if (!picture.note.empty()) json_[picture.name]["note"] = picture.note;
      return;
    }
    fmt::print("{:<40} {:>9.3f} {:>9.3f}{}{}\n", picture.name, found.full[0], found.quantized[0],
               picture.note.empty() ? "" : "  ", picture.note);
  }

  void AddFailure(const std::string& path, const std::string& why) {
    ++failed_;
    if (in_json_) json_[std::filesystem::path(path).filename().string()] = {{"error", why}};
    Tell("{}", OneLine(why));
  }

  int Finish(const detection::PictureList& list) const {
    // Names are bytes; what is no text among them is replaced.
    if (in_json_) fmt::print("{}\n", JsonText(json_));
    if (list.passed_over > 0) Tell("note: {} of other kinds passed over", Counted(list.passed_over, "file"));
    if (failed_ == 0) return kDone;
    Tell("{} without a score, {} scored", Counted(failed_, "picture"), read_);
    return read_ == 0 ? kBadInput : kMissionsFailed;
  }

 private:
  bool in_json_;
  Json json_ = Json::object();
  std::int64_t read_ = 0, failed_ = 0;
};

int LookAtPictures(const Options& options, const perception::DetectorPair& detectors) {
  const detection::PictureList list = detection::ListPictures(options.path);
  const auto look = [&](const std::string& path) {
    detection::NamedPicture picture = detection::ReadNamedPicture(path);
    Confidences found = Look(detectors, picture.frame);
    return std::pair(std::move(picture), std::move(found));
  };
  if (!std::filesystem::is_directory(options.path)) {
    const auto [picture, found] = look(options.path);
    PictureTable table(options.json);
    table.Add(picture, found);
    return table.Finish(list);
  }
  PictureTable table(options.json);
  for (const std::string& path : list.paths) {
    try {
      const auto [picture, found] = look(path);
      table.Add(picture, found);
    } catch (const perception::DetectorError& error) {
      table.AddFailure(path, fmt::format("{}: {}", path, error.what()));
    } catch (const UserError& error) {
      table.AddFailure(path, error.what());
    }
  }
  return table.Finish(list);
}

// Said of pictures alone: the frames of 'ed3r frames' are of the kind that the built-in networks learnt from.
void NoteBuiltin(const DetectorConfig& config) {
  std::vector<std::string> built_in;
  if (config.full == "builtin") built_in.emplace_back("Full");
  if (config.quantized == "builtin") built_in.emplace_back("Quantized");
  if (!built_in.empty())
    Tell(
        "note: {} built in and learnt from rendered frames alone; photographs of fires and of forests "
        "score alike. Your own: --set perception.detector.full=mine.onnx",
        built_in.size() > 1 ? "both networks are" : built_in.front() + " is");
}

int Detect(const Options& options) {
  Config config;
  ApplySettings(options.settings, Scope::kMission, config);
  const perception::DetectorPair detectors = perception::LoadDetectors(config.perception.detector);
  if (detection::IsFrameSet(options.path)) return Evaluate(options, config.perception.detector, detectors);
  if (!options.table.empty()) throw UserError("--table: is for a folder of 'ed3r frames'");
  const int status = LookAtPictures(options, detectors);
  NoteBuiltin(config.perception.detector);
  return status;
}

}  // namespace

Command AddDetect(Program& program) {
  auto options = std::make_shared<Options>();
  CommandLine parser = program.AddCommand("detect",
                                          "What the detectors say of a data set of 'ed3r frames' (scores "
                                          "by distance and occlusion) or of pictures, PNG or JPEG: of 16 "
                                          "bits a channel the upper 8, what is see-through over black");
  parser.Option("PATH", options->path, "Folder of 'ed3r frames', folder of pictures, or one picture")
      .Required();
  parser.Option("--set", options->settings, "KEY=VALUE; e.g. perception.detector.full=mine.onnx").OneValue();
  parser.Option("--table", options->table, "CSV file for the confidences in each frame of 'ed3r frames'");
  parser.Flag("--json", options->json, "Print JSON");
  return {parser, [options] { return Detect(*options); }};
}

}  // namespace ed3r::app
