#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <optional>

#include "engine/app/commands.h"
#include "engine/app/decision_text.h"
#include "engine/app/pictures/mission_film.h"
#include "engine/app/pictures/mission_pictures.h"
#include "engine/app/pictures/mission_viewer.h"
#include "engine/app/stored_run.h"
#include "engine/app/words.h"
#include "engine/core/check.h"
#include "engine/core/files/file.h"
#include "engine/core/files/remove_file.h"
#include "engine/store/directory_lock.h"
#include "engine/world/map_picture.h"
#include "studies/metrics/number_text.h"
#include "studies/report/web_page.h"

namespace ed3r::app {
namespace {

struct Options {
  std::string dir, mission, out, video;
  std::string cache = "results/cache";
  std::vector<int> frames;  // timesteps
  bool html = false;
  std::string beside;
};

class TraceFile : public robot::TraceSink {
 public:
  // `also` hears the same; none: nullptr.
  TraceFile(AtomicFile& file, robot::TraceSink* also) : file_(file), also_(also) {
    file_.Write("timestep,time_s,x_m,y_m,z_m,vx_mps,vy_mps,vz_mps,yaw_rad\n");
  }
  void Record(const robot::TraceSample& s) override {
    file_.Write(fmt::format("{},{},{},{},{},{},{},{},{}\n", s.timestep, s.time_s, s.position_m.x(),
                            s.position_m.y(), s.position_m.z(), s.velocity_mps.x(), s.velocity_mps.y(),
                            s.velocity_mps.z(), s.yaw_rad));
    if (also_ != nullptr) also_->Record(s);
  }

 private:
  AtomicFile& file_;
  robot::TraceSink* also_;
};

std::string CellOf(std::string_view, double value) { return metrics::CsvNumber(value); }

std::string CellOf(std::string_view column, std::int64_t value) {
  const std::string_view name = CodeName(column, value);
  return name.empty() ? fmt::format("{}", value) : std::string(name);
}

std::string StepsText(const mission::MissionRecord& record) {
  std::string file;
  char separator = '\0';
  const mission::TimestepRecord columns;
  mission::TimestepRecord::Describe(columns, [&](std::string_view name, const auto&) {
    if (separator != '\0') file += separator;
    file += name;
    separator = ',';
  });
  for (const mission::TimestepRecord& step : record.steps) {
    separator = '\n';
    mission::TimestepRecord::Describe(step, [&](std::string_view name, const auto& value) {
      file += separator;
      file += CellOf(name, value);
      separator = ',';
    });
  }
  return file + "\n";
}

// "step003_frames.png", "step003_large.png"
bool IsStepPicture(std::string_view name) {
  constexpr std::string_view kBegin = "step";
  const std::size_t end = name.find('_');
  if (!name.starts_with(kBegin) || end == std::string_view::npos || end < kBegin.size() + 3) return false;
  const std::string_view number = name.substr(kBegin.size(), end - kBegin.size()), rest = name.substr(end);
  return number.find_first_not_of("0123456789") == std::string_view::npos &&
         (rest == "_frames.png" || rest == "_large.png");
}

// Of another mission, they would be taken for this one's.
void RemoveReplay(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> found;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (IsStepPicture(entry.path().filename().string())) found.push_back(entry.path());
  for (const char* name : {"timesteps.csv", "trace.csv", "map.png", "mission.html"})
    found.push_back(folder / name);
  for (const std::filesystem::path& path : found) RemoveFile(path);
}

void CheckFrames(const std::vector<int>& frames, std::int64_t timesteps) {
  for (const int k : frames)
    if (k < 1 || k > timesteps)
      throw UserError(
          fmt::format("--frames {}: is not allowed; the mission has timesteps 1 .. {}", k, timesteps));
}

// The viewer of one mission, or of two on one clock, as one file.
void WriteViewer(StoredRun& run, const Options& options, const world::Scene& scene,
                 const report::WebBundle& bundle, const std::filesystem::path& path) {
  nlohmann::ordered_json data = {{"format", 1},
                                 {"run", run.Plan().name},
                                 {"world", ViewerWorld(scene)},
                                 {"missions", {ViewerMission(run, options.mission)}}};
  if (!options.beside.empty()) data["missions"].push_back(ViewerMission(run, options.beside));
  std::string title = options.mission;
  if (!options.beside.empty()) title += " beside " + options.beside;
  WriteFile(path,
            report::SelfContainedPage(title + report::kMissionTitle, bundle, data,
                                      "<p>The viewer is a program: it needs scripts. 'ed3r replay' without "
                                      "--html writes the mission's map and tables.</p>"));
}

// Two missions are shown in one world.
void CheckBeside(StoredRun& run, const Options& options, const world::Scene& scene) {
  if (options.beside.empty()) return;
  if (!options.html) throw UserError("--beside: is of --html, the viewer of two missions");
  if (&run.Task(run.Find(options.beside)).scene != &scene)
    throw UserError(
        fmt::format("--beside {}: flies in another world than {}", options.beside, options.mission));
}

report::WebBundle ViewerBundle() {
  const report::FoundBundle found = report::FindWebBundle("viewer");
  if (!found.bundle) throw UserError("--html: " + found.why_not);
  return *found.bundle;
}

int Replay(const Options& options) {
  StoredRun run(options.dir, options.cache);
  const sweep::RunId id = run.Find(options.mission);
  const store::StoredMission stored = run.Reader().LoadMission(id);
  CheckFrames(options.frames, stored.record.timesteps);  // before anything is flown or written
  std::string name = options.mission;
  for (char& c : name)
    if (c == '/') c = '-';
  const std::filesystem::path out = options.out.empty() ? std::filesystem::path(options.dir) / "replay" / name
                                                        : std::filesystem::path(options.out);
  mission::MissionTask task = run.Task(id);
  CheckBeside(run, options, task.scene);
  std::optional<report::WebBundle> viewer;
  if (options.html) viewer = ViewerBundle();
  std::optional<MissionPictures> pictures;
  if (!options.frames.empty()) pictures.emplace(task);
  std::optional<MissionFilm> film;
  if (!options.video.empty()) film.emplace(task, options.video);
  MakeFolder(out);
  const auto alone = store::LockToWrite(out.string());

  FileSet files;
  TraceFile trace(files.Add(out / "trace.csv"), film ? &*film : nullptr);
  task.trace = &trace;
  const mission::MissionRecord flown = mission::FlyMission(task);
  const bool identical = run.Reader().IsStored(flown, stored);
  const std::string steps = StepsText(flown);
  files.Add(out / "timesteps.csv", steps);
  std::string there, ignored;
  if (!TryReadFile((out / "timesteps.csv").string(), kMaxTextBytes, there, ignored) || there != steps)
    RemoveReplay(out);
  std::vector<Eigen::Vector3d> path_m = {{flown.start_x_m, flown.start_y_m, flown.start_z_m}};
  for (const mission::TimestepRecord& step : flown.steps) path_m.emplace_back(step.x_m, step.y_m, step.z_m);
  world::WriteMapPicture(task.scene, (out / "map.png").string(),
                         {.path_m = path_m, .site = static_cast<int>(flown.site)});
  for (const int k : options.frames)
    if (k <= flown.timesteps)  // a flight that differs may be shorter
      fmt::print("{}", pictures->Write(flown, k, (out / fmt::format("step{:03}", k)).string()));
  if (viewer) WriteViewer(run, options, task.scene, *viewer, out / "mission.html");
  files.Commit();  // last: where timesteps.csv is, all is of its mission
  if (film) fmt::print("{}", film->Write(flown, options.mission + " of " + run.Plan().name));
  fmt::print("{}: {} in {}, {:.1f} s, {:.2f} kJ; {}\n", options.mission,
             NameOf(static_cast<mission::Outcome>(flown.outcome)), Counted(flown.timesteps, "timestep"),
             flown.duration_s, flown.total_j / 1000.0,
             identical ? "identical to the stored record" : "DIFFERS from the stored record");
  fmt::print("{}: trace.csv, timesteps.csv, map.png{}\n", out.string(), viewer ? ", mission.html" : "");
  FlushOutput();
  TellNotes(run.Notes());
  return identical ? kDone : kFailedInside;
}

}  // namespace

Command AddReplay(Program& program) {
  auto options = std::make_shared<Options>();
  CommandLine parser = program.AddCommand(
      "replay", "Flies a stored mission again, checks that it is identical, writes its trace and map");
  parser.Option("DIR", options->dir, "Run directory").Required();
  parser.Option("MISSION", options->mission, "ARM/NUMBER, e.g. rbs/12; missions count from 0").Required();
  parser.Option("--out", options->out, "Folder for trace and map; default DIR/replay/MISSION");
  parser.Option(
      "--video", options->video,
      "Also the mission as a film of about a minute at most, FILE.mp4: what the camera sees, with time, "
      "SCS, battery and command, and the map from above");
  parser
      .Option("--frames", options->frames,
              "Also pictures of what the camera saw in these timesteps, from 1; e.g. 1,4 or 1 4")
      .Numbers("K[,K...]");
  parser.Flag("--html", options->html,
              "Also mission.html: the mission to watch in a browser, in one file that needs no network");
  parser.Option("--beside", options->beside,
                "Another mission, shown beside it on the same clock (with --html)");
  parser.Option("--cache", options->cache, "Where trained networks are kept; default results/cache");
  return {parser, [options] { return Replay(*options); }};
}

}  // namespace ed3r::app
