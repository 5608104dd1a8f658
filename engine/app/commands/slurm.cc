#include "engine/app/commands/slurm.h"

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <memory>

#include "engine/app/expected_time.h"
#include "engine/app/sweep_arguments.h"
#include "engine/app/words.h"
#include "engine/core/check.h"
#include "engine/core/files/file.h"
#include "engine/core/files/remove_file.h"
#include "engine/schedule/batch/owed.h"
#include "engine/schedule/batch/shell.h"
#include "engine/schedule/batch/slurm_limits.h"
#include "engine/schedule/batch/slurm_scripts.h"
#include "engine/schedule/inputs.h"
#include "engine/schedule/training_stage.h"
#include "studies/report/load.h"

namespace ed3r::app {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kMaxShards = 100'000;
constexpr char kSubmit[] = "submit.sh";

struct Options {
  SweepArguments sweep;
  std::string out;
  std::string cache = "results/cache";
  std::string time, memory, partition, account, scratch;
  std::int64_t shards = 16, cpus = 1, array_limit = 1000;
  bool submit = false, missing = false, force = false;
};

std::string Absolute(const std::string& path) { return fs::absolute(path).lexically_normal().string(); }

void CheckDirective(const char* option, const std::string& value) {
  if (!value.empty() && !schedule::IsDirectiveWord(value))
    throw UserError(
        fmt::format("{}: '{}' is not allowed; allowed: letters, digits and ._:,=@%+/[]-", option, value));
}

// A task that has no time left after the notice would be requeued again and again.
void CheckTime(const std::string& time) {
  constexpr int kShortest_s = 2 * schedule::kNotice_s;
  if (time.empty()) return;
  const auto time_s = schedule::SlurmTime_s(time);
  if (!time_s)
    throw UserError(fmt::format(
        "--time: '{}' is not allowed; allowed: minutes, minutes:seconds, hours:minutes:seconds, days-hours, "
        "days-hours:minutes and days-hours:minutes:seconds, such as 03:00:00",
        time));
  if (*time_s < kShortest_s)
    throw UserError(fmt::format(
        "--time: '{}' is {} s, and tasks are told {} s before their end or earlier; give {} minutes or more",
        time, *time_s, schedule::kNotice_s, kShortest_s / 60));
}

void CheckMemory(const std::string& memory) {
  if (!memory.empty() && !schedule::IsSlurmMemory(memory))
    throw UserError(fmt::format(
        "--mem: '{}' is not allowed; allowed: a number above 0 with K, M, G or T, such as 500M", memory));
}

std::vector<std::string> SweepWords(const SweepArguments& sweep) {
  std::vector<std::string> words = {Absolute(sweep.file)};
  for (const std::string& set : sweep.set) words.insert(words.end(), {"--set", set});
  if (!sweep.seed.empty()) words.insert(words.end(), {"--seed", sweep.seed});
  for (const std::string& missions : sweep.missions) words.insert(words.end(), {"--missions", missions});
  return words;
}

schedule::SlurmOptions ScriptOptions(const Options& options, const std::string& run_dir) {
  schedule::SlurmOptions slurm;
  slurm.program = fs::read_symlink("/proc/self/exe").string();
  slurm.sweep = SweepWords(options.sweep);
  slurm.working_dir = fs::current_path().string();
  slurm.run_dir = Absolute(run_dir);
  slurm.cache_dir = Absolute(options.cache);
  slurm.partition = options.partition;
  slurm.account = options.account;
  slurm.time = options.time;
  slurm.memory = options.memory;
  slurm.scratch = options.scratch;
  slurm.shards = options.shards;
  slurm.cpus = options.cpus;
  slurm.array_limit = options.array_limit;
  return slurm;
}

std::vector<schedule::BatchStep> Steps(const sweep::SweepPlan& plan, std::int64_t shards) {
  std::vector<double> expected_core_s;
  const ExpectedTraining training = ExpectedTrainingOf(plan);
  for (const sweep::Stage& stage : plan.stages)
    expected_core_s.push_back(stage.kind == sweep::StageKind::kTrain
                                  ? training.core_s * static_cast<double>(training.networks)
                                  : ExpectedCoreS(stage));
  return schedule::StepsOf(plan, shards, schedule::NeedsNetworks(plan) ? schedule::CountNetworks(plan) : 0,
                           expected_core_s);
}

// Scripts are there to be edited: what somebody has changed is not written over.
void Write(const std::vector<schedule::BatchFile>& files, const fs::path& folder, bool force) {
  for (const schedule::BatchFile& file : files) {
    const fs::path path = folder / file.name;
    if (force || !fs::exists(path) || ReadFile(path.string()) == file.content) continue;
    throw UserError(fmt::format(
        "{}: differs from what these options give; submit it as it is with {}, or give --force to "
        "write over it",
        path.string(), (folder / kSubmit).string()));
  }
  MakeFolder(folder);
  MakeFolder(folder / "logs");
  const auto is_there = [&](const schedule::BatchFile& file) {
    const fs::path path = folder / file.name;
    return fs::exists(path) && ReadFile(path.string()) == file.content;
  };
  if (std::all_of(files.begin(), files.end(), is_there)) return;
  // A task that begins just now finds every script; what submits them is not there until all are of this call.
  RemoveFile(folder / kSubmit);
  for (const bool last : {false, true})
    for (const schedule::BatchFile& file : files)
      if ((file.name == kSubmit) == last && !is_there(file)) WriteFile(folder / file.name, file.content);
  for (const schedule::BatchFile& file : files)
    if (file.executable)
      fs::permissions(folder / file.name,
                      fs::perms::owner_exec | fs::perms::group_exec | fs::perms::others_exec,
                      fs::perm_options::add);
}

// The scripts fly what they were written for, whatever is asked for now; "" where that is the same.
std::string OtherSweep(const fs::path& folder, const SweepArguments& sweep) {
  const std::string opening = "\nsweep=(", words = schedule::ShellWords(SweepWords(sweep));
  const std::string common = (folder / "common.sh").string(), text = ReadFile(common);
  const std::size_t begin = text.find(opening), end = text.find('\n', begin + 1);
  if (begin == std::string::npos) return "";
  std::string there = text.substr(begin + opening.size(), end - begin - opening.size());
  if (there.ends_with(')')) there.pop_back();
  if (there != words)
    return fmt::format("{}: its tasks fly '{}', not '{}' as asked for here", common, there, words);
  return "";
}

// A folder that was moved still names the one that it was made for.
std::string OtherRun(const fs::path& folder, const std::string& run_dir) {
  const std::string common = (folder / "common.sh").string(), text = ReadFile(common), opening = "\nrun=";
  const std::size_t begin = text.find(opening);
  if (begin == std::string::npos) return "";
  const std::string line =
      text.substr(begin + opening.size(), text.find('\n', begin + 1) - begin - opening.size());
  const std::string here = schedule::ShellWord(run_dir);
  // The word may have blanks, and a remark follows it.
  if (line.starts_with(here) && (line.size() == here.size() || line[here.size()] == ' ')) return "";
  const std::string there = line.substr(0, line.find("  "));
  return fmt::format("{}: its tasks write into {}, not into {}", common, there, here);
}

// How many shards the scripts in the folder divide a stage into.
std::int64_t ShardsOfScripts(const fs::path& folder) {
  const std::string common = (folder / "common.sh").string();
  if (!fs::exists(common))
    throw UserError(
        fmt::format("{}: no batch scripts in it; 'ed3r slurm SWEEP' writes them", folder.string()));
  const std::string text = ReadFile(common);
  const std::size_t at = text.find(schedule::kShardsLine);
  std::int64_t shards = 0;
  if (at != std::string::npos) {
    const char* const begin = text.data() + at + std::strlen(schedule::kShardsLine);
    std::from_chars(begin, text.data() + text.size(), shards);
  }
  if (shards < 1 || shards > kMaxShards)
    throw UserError(
        fmt::format("{}: no line '{}N' with N in 1 .. {}", common, schedule::kShardsLine + 1, kMaxShards));
  return shards;
}

int Submit(const fs::path& folder, const std::vector<std::string>& arguments) {
  std::vector<std::string> command = {(folder / kSubmit).string()};
  command.insert(command.end(), arguments.begin(), arguments.end());
  std::vector<char*> words;
  words.reserve(command.size() + 1);
  for (std::string& word : command) words.push_back(word.data());
  words.push_back(nullptr);
  FlushOutput();  // before what the script says
  pid_t child = 0;
  if (const int error = posix_spawn(&child, words.front(), nullptr, nullptr, words.data(), environ);
      error != 0)
    throw UserError(fmt::format("{}: cannot be run: {}", command.front(), std::strerror(error)));
  int status = 0;
  while (waitpid(child, &status, 0) < 0)
    if (errno != EINTR) throw InternalError(fmt::format("{}: {}", command.front(), std::strerror(errno)));
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return kDone;
  Tell("{}: ended with {}; what it has submitted stays", command.front(),
       WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status));
  return kFailedInside;
}

int TellMissing(const sweep::SweepPlan& plan, const Options& options, const fs::path& folder,
                const std::string& run_dir) {
  const std::vector<schedule::BatchStep> steps = Steps(plan, ShardsOfScripts(folder));
  const schedule::Owed owed = schedule::WhatIsOwed(plan, steps, run_dir, options.cache, report::HalfWidth);
  if (owed.step == 0) {
    fmt::print("{}: nothing is owed\n", run_dir);
    return kDone;
  }
  for (const std::string& other :
       {OtherSweep(folder, options.sweep), OtherRun(folder, ScriptOptions(options, run_dir).run_dir)}) {
    if (other.empty()) continue;
    if (options.submit)
      throw UserError(other + "; give what they were written for, or write the scripts anew with --force");
    Tell("note: {}", other);
  }
  const schedule::BatchStep& step = steps[static_cast<std::size_t>(owed.step) - 1];
  fmt::print("{}: step {} on", run_dir, step.name);
  if (!owed.tasks.empty())
    fmt::print(", {} of its {} tasks: {}", owed.tasks.size(), step.tasks, schedule::TaskList(owed.tasks));
  if (owed.missions > 0) fmt::print(" ({} owed)", Counted(owed.missions, "mission"));
  std::vector<std::string> arguments = {fmt::format("{}", owed.step)};
  for (const std::string& array : schedule::ArraysOf(owed.tasks, options.array_limit))
    arguments.push_back(array);
  fmt::print("\n{} {}\n", schedule::ShellWord((folder / kSubmit).string()), schedule::ShellWords(arguments));
  return options.submit ? Submit(folder, arguments) : kDone;
}

int Run(const Options& options) {
  CheckTime(options.time);
  CheckMemory(options.memory);
  CheckDirective("--partition", options.partition);
  CheckDirective("--account", options.account);
  if (options.scratch.find_first_of("\"`\\\n") != std::string::npos)
    throw UserError(fmt::format(
        "--scratch: '{}' is not allowed; allowed: a path, or a variable such as $TMPDIR", options.scratch));
  const sweep::SweepPlan plan = options.sweep.Load();
  schedule::CheckPlan(plan);
  const std::string run_dir = options.out.empty() ? DefaultRunDir(plan) : options.out;
  const fs::path folder = fs::path(run_dir) / "slurm";
  if (options.missing) return TellMissing(plan, options, folder, run_dir);
  const std::vector<schedule::BatchStep> steps = Steps(plan, options.shards);
  Write(schedule::SlurmScripts(plan.name, steps, ScriptOptions(options, run_dir)), folder, options.force);
  fmt::print("{}: {}, from {} to {}\n", folder.string(),
             Counted(static_cast<std::int64_t>(steps.size()), "step"), steps.front().name, steps.back().name);
  if (options.time.empty())
    fmt::print(
        stderr,
        "note: without --time, or a line for it in the scripts, no task is told before the site's limit "
        "ends it and all that was to follow\n");
  if (options.submit) return Submit(folder, {});
  fmt::print("submit them with {}\n", schedule::ShellWord((folder / kSubmit).string()));
  return kDone;
}

}  // namespace

Command AddSlurm(Program& program) {
  auto options = std::make_shared<Options>();
  CommandLine parser = program.AddCommand(
      "slurm", "Writes a sweep as batch scripts for Slurm, to be read, edited and submitted: RUN/slurm");
  options->sweep.AddTo(parser);
  parser.Option("--out", options->out,
                "Run directory, on a disk that all nodes share; default results/runs/<sweep name>");
  parser.Option("--cache", options->cache,
                "Where trained networks are kept, likewise; default results/cache");
  parser.Option("--shards", options->shards, "Tasks of a stage's flights; default 16").Range(1, kMaxShards);
  parser.Option("--cpus-per-task", options->cpus, "Threads of a task; default 1").Range(1, 4096);
  parser.Option("--time", options->time,
                "Time limit of a task, as sbatch takes it, such as 03:00:00; default: the site's");
  parser.Option("--mem", options->memory,
                "Memory of a task, as sbatch takes it, such as 1G; default: the site's");
  parser.Option("--partition", options->partition, "Partition; default: the site's");
  parser.Option("--account", options->account, "Account; default: the site's");
  parser
      .Option("--array-limit", options->array_limit,
              "Tasks of one job array at most (the site's MaxArraySize less one); default 1000")
      .Range(1, kMaxShards);
  parser.Option("--scratch", options->scratch,
                "Fly on a disk of the node's own, such as '$TMPDIR', and move the store at the end");
  parser.Flag("--submit", options->submit, "Submit them");
  parser.Flag(
      "--missing", options->missing,
      "Say which tasks are still owed by what is stored; with --submit, submit just those and what follows");
  parser.Flag("--force", options->force, "Write over scripts that have been edited").Excludes({"--missing"});
  return {parser, [options] { return Run(*options); }};
}

}  // namespace ed3r::app
