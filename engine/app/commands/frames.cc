#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <span>

#include "engine/app/commands.h"
#include "engine/app/settings.h"
#include "engine/core/check.h"
#include "engine/core/files/file.h"
#include "engine/core/files/new_folder.h"
#include "engine/core/files/remove_file.h"
#include "engine/core/files/shipped.h"
#include "engine/core/files/temporary_file.h"
#include "engine/core/progress.h"
#include "engine/core/sha256.h"
#include "engine/core/version.h"
#include "engine/perception/render/pictures.h"
#include "engine/perception/render/renderer.h"
#include "engine/perception/render/training_views.h"
#include "engine/perception/vision/frame_detector.h"
#include "engine/store/directory_lock.h"
#include "engine/world/world_file.h"

namespace ed3r::app {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxViews = 1000000;
constexpr int kEnlarged = 8;
constexpr perception::PictureSize kLarge{960, 540};

struct Options {
  std::string out, size;
  std::vector<std::string> worlds;
  std::vector<std::string> settings;
  int views = 1000;
  int frames = 4;
  int pictures = 8;
  double wrong_by = 0.0;
  std::uint64_t seed = 20260101;
};

perception::PictureSize SizeOf(const Options& options, const Config& config) {
  if (options.size.empty()) return {config.perception.render.width_px, config.perception.render.height_px};
  for (const std::string& setting : options.settings)
    if (setting.starts_with("perception.render.width_px=") ||
        setting.starts_with("perception.render.height_px="))
      throw UserError(
          fmt::format("--size: is not allowed beside --set {}: both say the size; leave one out", setting));
  perception::PictureSize size{0, 0};
  const char* const end = options.size.data() + options.size.size();
  const auto width = std::from_chars(options.size.data(), end, size.width_px);
  if (width.ec == std::errc() && width.ptr != end && *width.ptr == 'x') {
    const auto height = std::from_chars(width.ptr + 1, end, size.height_px);
    if (height.ec == std::errc() && height.ptr == end && size.width_px >= 16 && size.width_px <= 1920 &&
        size.height_px >= 9 && size.height_px <= 1080)
      return size;
  }
  throw UserError(fmt::format("--size: '{}' is not allowed; allowed: WxH, 16x9 .. 1920x1080", options.size));
}

void CheckCount(const char* option, int value, int min, int max) {
  if (value < min || value > max)
    throw UserError(fmt::format("{}: {} is not allowed; allowed: {} .. {}", option, value, min, max));
}

// The frames as one NumPy array (NPY 1.0, uint8, N x H x W x 3, C order), written as they come.
class FrameFile {
 public:
  FrameFile(AtomicFile& file, int frames, perception::PictureSize size) : file_(file) {
    std::string header = fmt::format("{{'descr': '|u1', 'fortran_order': False, 'shape': ({}, {}, {}, 3), }}",
                                     frames, size.height_px, size.width_px);
    // Magic, version and length take 10 bytes; the data begin at a multiple of 64.
    header.append(63 - (header.size() + 10) % 64, ' ');
    header += '\n';
    std::string start("\x93NUMPY\x01\x00", 8);
    start += static_cast<char>(header.size() & 0xff);
    start += static_cast<char>(header.size() >> 8);
    Write(start.data(), start.size());
    Write(header.data(), header.size());
  }
  void Append(const perception::FrameStack& stack) { Write(stack.rgb.data(), stack.rgb.size()); }
  // The last call; SHA-256 of the whole file.
  std::string Hash() { return hash_.Hex(); }

 private:
  void Write(const void* data, std::size_t bytes) {
    file_.Write({static_cast<const char*>(data), bytes});
    hash_.Update(data, bytes);
  }
  AtomicFile& file_;
  Sha256 hash_;
};

// "view_00012.png", "view_00012_large.png"
bool IsPictureName(std::string_view name) {
  constexpr std::string_view kBegin = "view_", kEnd = ".png", kLargeEnd = "_large.png";
  if (!name.starts_with(kBegin) || !name.ends_with(kEnd)) return false;
  name.remove_prefix(kBegin.size());
  name.remove_suffix(name.ends_with(kLargeEnd) ? kLargeEnd.size() : kEnd.size());
  return name.size() >= 5 && name.find_first_not_of("0123456789") == std::string_view::npos;
}

// Of another set, whose views they show.
void RemovePictures(const fs::path& folder) {
  std::vector<fs::path> found;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    if (IsPictureName(entry.path().filename().string())) found.push_back(entry.path());
  for (const fs::path& picture : found) RemoveFile(picture);
}

class DataSet {
 public:
  DataSet(const Options& options, const Config& config)
      : options_(options), config_(config), size_(SizeOf(options, config)) {
    CheckCount("--views", options.views, 1, kMaxViews);
    CheckCount("--frames", options.frames, 1, config.sensing.Frames());
    CheckCount("--pictures", options.pictures, 0, 1000);
    for (const std::string& file : Worlds()) {
      for (const char* output : {"frames.npy", "labels.csv", "manifest.json"})
        CheckNoInput(fs::path(options.out) / output, world::FilesOf(world::ReadWorldFile(file)), "--out");
      worlds_.push_back(world::Scene::Load(file));
      if (worlds_.back()->Sites().empty())
        throw UserError(file + ": a world without fire sites cannot be used here");
      scenes_.push_back(std::make_shared<perception::TraceScene>(*worlds_.back()));
    }
    if (!(options.wrong_by >= 0.0 && options.wrong_by <= 1.0))
      throw UserError(fmt::format("--wrong-by: {} is not allowed; allowed: 0 .. 1", options.wrong_by));
    if (options.wrong_by > 0.0) detectors_ = perception::LoadDetectors(config.perception.detector);
    for (int i = 0; i < options.frames; ++i) numbers_.push_back(i * config.sensing.Frames() / options.frames);
  }

  void Write() {
    const fs::path out(options_.out);
    const NewFolder made(out);
    const auto alone = store::LockToWrite(out.string());
    FileSet files;
    FrameFile frames(files.Add(out / "frames.npy"), options_.views * options_.frames, size_);
    std::string labels =
        "index,view,frame,world,site,distance_m,fire_px,smoke_px,occluded,label,tilt_deg,"
        "haze_range_m,sun_deg,cloud_cover,distractors\n";
    ProgressLine line(stderr, false);
    int looks = 0;
    for (int kept = 0; kept < options_.views; ++looks) {
      if (looks == kMaxViews)
        throw UserError(
            fmt::format("--wrong-by: of {} views only {} are wrong by {}", looks, kept, options_.wrong_by));
      line.Show(fmt::format("frames  {}/{} views, {} looked at", kept, options_.views, looks));
      if (WriteView(looks, kept, frames, labels)) ++kept;
    }
    line.Clear();
    Sha256 of_labels;
    of_labels.Update(labels);
    files.Add(out / "labels.csv", labels);
    files.Add(out / "manifest.json", Manifest(looks, frames.Hash(), of_labels.Hex()));
    const TemporaryFolder pictures(out);  // what is there stays until all is made
    for (const int view : pictured_) WritePictures(view, pictures.path());
    RemoveFile(out / "manifest.json");  // it comes last: where it is, all is of its set
    RemovePictures(out);
    for (const fs::directory_entry& picture : fs::directory_iterator(pictures.path()))
      fs::rename(picture.path(), out / picture.path().filename());
    files.Commit();
    fmt::print(
        "{}: frames.npy ({} views x {} frames, {} x {} px), labels.csv, manifest.json; fire or smoke in {} "
        "views\n",
        options_.out, options_.views, options_.frames, size_.width_px, size_.height_px, with_fire_);
  }

 private:
  std::vector<std::string> Worlds() const {
    if (!options_.worlds.empty()) return options_.worlds;
    const fs::path shipped = ShippedSweeps() / "worlds";
    return {shipped / "training_a.yaml", shipped / "training_b.yaml", shipped / "training_c.yaml"};
  }

  // Whether a detector's confidence in the first frame is as far from the truth as is asked for.
  bool Misjudged(const perception::SensingFrames& sensed) const {
    const perception::FrameStack& all = sensed.frames;
    const auto first = static_cast<std::ptrdiff_t>(all.rgb.size()) / all.frames;
    const perception::FrameStack frame{.frames = 1,
                                       .width_px = all.width_px,
                                       .height_px = all.height_px,
                                       .rgb = {all.rgb.begin(), all.rgb.begin() + first}};
    const double truth = sensed.truth.FireInView() ? 1.0 : 0.0;
    for (const auto& detector : {detectors_.full, detectors_.quantized}) {
      double confidence = 0.0;
      detector->Confidences(frame, std::span(&confidence, 1));
      if (std::abs(confidence - truth) >= options_.wrong_by) return true;
    }
    return false;
  }

  // False for a view that is not asked for. kept: views written before.
  bool WriteView(int view, int kept, FrameFile& frames, std::string& labels) {
    const auto number = static_cast<std::uint32_t>(view);
    const perception::ViewPlan plan = perception::PlanView(scenes_, config_, options_.seed, number);
    const auto world = static_cast<std::size_t>(plan.world);
    const perception::Renderer renderer(scenes_[world], plan.site, config_.perception, config_.sensing,
                                        options_.seed, number);
    const perception::SensingFrames sensed = renderer.Sense(plan.pose, 1, numbers_, size_);
    if (options_.wrong_by > 0.0 && !Misjudged(sensed)) return false;
    frames.Append(sensed.frames);
    const perception::GroundTruth& truth = sensed.truth;
    const bool fire = truth.FireInView();
    with_fire_ += fire ? 1 : 0;
    const world::Scene& scene = *worlds_[world];
    const std::string props = perception::PropsInView(renderer, scene, plan.pose, config_.sensing);
    const perception::Ambience& weather = renderer.Weather();
    for (int i = 0; i < options_.frames; ++i)
      labels +=
          fmt::format("{},{},{},\"{}\",\"{}\",{:.1f},{},{},{:.3f},{},{:.1f},{:.0f},{:.1f},{:.2f},{}\n",
                      kept * options_.frames + i, view, numbers_[static_cast<std::size_t>(i)], scene.Name(),
                      scene.Sites()[static_cast<std::size_t>(plan.site)].name, truth.distance_m,
                      truth.fire_px, truth.smoke_px, truth.occluded, fire ? 1 : 0,
                      plan.pose.tilt_rad * 180.0 / std::numbers::pi, weather.haze_range_m,
                      std::asin(weather.to_sun.z()) * 180.0 / std::numbers::pi, weather.cloud_cover, props);
    if (kept < options_.pictures) pictured_.push_back(view);
    return true;
  }

  // Rendered once more, as they are written when nothing can be refused any more.
  void WritePictures(int view, const fs::path& folder) const {
    const auto number = static_cast<std::uint32_t>(view);
    const perception::ViewPlan plan = perception::PlanView(scenes_, config_, options_.seed, number);
    const perception::Renderer renderer(scenes_[static_cast<std::size_t>(plan.world)], plan.site,
                                        config_.perception, config_.sensing, options_.seed, number);
    const perception::FrameStack frames = renderer.Sense(plan.pose, 1, numbers_, size_).frames;
    const std::string stem = (folder / fmt::format("view_{:05}", view)).string();
    perception::WriteFrame(frames, 0, stem + ".png", size_.width_px <= 240 ? kEnlarged : 1);
    const int first[] = {0};
    perception::WriteFrame(renderer.Sense(plan.pose, 1, first, kLarge).frames, 0, stem + "_large.png");
  }

  std::string Manifest(int looks, const std::string& of_frames, const std::string& of_labels) const {
    nlohmann::ordered_json manifest;
    manifest["seed"] = options_.seed;
    manifest["views"] = options_.views;
    if (options_.wrong_by > 0.0) {
      manifest["wrong_by"] = options_.wrong_by;
      manifest["views_looked_at"] = looks;
      manifest["detectors"] = detectors_.fingerprint;
    }
    manifest["frames_per_view"] = options_.frames;
    manifest["frame_numbers"] = numbers_;
    manifest["width_px"] = size_.width_px;
    manifest["height_px"] = size_.height_px;
    manifest["views_with_fire"] = with_fire_;
    manifest["views_without_fire"] = options_.views - with_fire_;
    for (const auto& world : worlds_)
      manifest["worlds"].push_back({{"name", world->Name()}, {"fingerprint", world->Fingerprint()}});
    manifest["settings"] = options_.settings;
    const CodeVersion code = ThisCode();
    manifest["code"] = {{"source_hash", code.source_hash}, {"commit", code.commit}, {"dirty", code.dirty}};
    manifest["frames_npy_sha256"] = of_frames;
    manifest["labels_csv_sha256"] = of_labels;
    return manifest.dump(2) + "\n";
  }

  const Options& options_;
  const Config& config_;
  perception::PictureSize size_;
  std::vector<std::shared_ptr<const world::Scene>> worlds_;
  std::vector<std::shared_ptr<const perception::TraceScene>> scenes_;
  perception::DetectorPair detectors_;  // of --wrong-by
  std::vector<int> numbers_;
  std::vector<int> pictured_;  // views
  int with_fire_ = 0;
};

int WriteFrames(const Options& options) {
  Config config;
  ApplySettings(options.settings, Scope::kMission, config);
  DataSet(options, config).Write();
  return kDone;
}

}  // namespace

Command AddFrames(Program& program) {
  auto options = std::make_shared<Options>();
  CommandLine parser = program.AddCommand("frames", "Renders a labelled data set for training detectors");
  parser.Option("--out", options->out, "Folder for frames.npy, labels.csv, manifest.json and pictures")
      .Required();
  parser
      .Option("--world", options->worlds,
              "World file (YAML), repeatable; default: training_a, training_b, training_c")
      .OneValue();
  parser.Option("--views", options->views, "Views, half of them with fire or smoke in sight; default 1000");
  parser.Option("--frames", options->frames,
                "Frames of each view, spread over its sensing period; default 4");
  parser.Option("--seed", options->seed, "Seed of poses, weather and flicker; default 20260101");
  parser.Option("--pictures", options->pictures, "Views of which PNG files are written too; default 8");
  parser.Option("--size", options->size, "WxH in pixels in place of perception.render's");
  parser.Option("--wrong-by", options->wrong_by,
                "Only views of which a detector's confidence is wrong by so much (0 .. 1), to learn from");
  parser.Option("--set", options->settings, "KEY=VALUE; e.g. perception.render.noise=4").OneValue();
  return {parser, [options] { return WriteFrames(*options); }};
}

}  // namespace ed3r::app
