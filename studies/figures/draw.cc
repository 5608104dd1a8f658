#include "studies/figures/draw.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <sstream>
#include <vector>

#include "engine/core/check.h"
#include "engine/core/files/file.h"
#include "engine/core/files/shipped.h"
#include "engine/core/files/temporary_file.h"
#include "engine/core/interrupt.h"

extern char** environ;

namespace ed3r::figures {
namespace {

namespace fs = std::filesystem;

constexpr int kNoMatplotlib = 3;  // the scripts' exit status for it

std::string Environment(const char* name, const char* otherwise) {
  const char* value = std::getenv(name);
  return value != nullptr && *value != '\0' ? value : otherwise;
}

// Pictures that the script made take their place whole.
void TakePictures(const fs::path& from, const fs::path& into) {
  for (const fs::directory_entry& entry : fs::directory_iterator(from))
    if (entry.is_regular_file() && (entry.path().extension() == ".png" || entry.path().extension() == ".svg"))
      fs::rename(entry.path(), into / entry.path().filename());
}

// The last line that is not empty: of a Python traceback the one that names the error.
std::string LastLine(const std::string& text) {
  std::istringstream lines(text);
  std::string last;
  for (std::string line; std::getline(lines, line);)
    if (!line.empty()) last = line;
  return last;
}

// Runs the program with standard error in `errors`; its exit status, 128 + the signal that ended it, or -errno.
int RunProgram(const std::vector<std::string>& command, const fs::path& errors) {
  std::vector<char*> arguments;
  for (const std::string& argument : command) arguments.push_back(const_cast<char*>(argument.c_str()));
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDERR_FILENO, errors.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  pid_t child = 0;
  const int failure = posix_spawn(&child, arguments.front(), &files, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  if (failure != 0) return -failure;
  int status = 0;
  while (waitpid(child, &status, 0) < 0)
    if (errno != EINTR) return -errno;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

std::string WhyNoMessage(int status) {
  constexpr int kEndedBySignal = 128;
  return status > kEndedBySignal ? fmt::format("ended by {}", SignalName(status - kEndedBySignal))
                                 : "no message";
}

}  // namespace

DrawResult DrawFigures(const std::string& folder, const std::string& script_name) {
  const std::string python = Environment("ED3R_PYTHON", "/usr/bin/python3");
  const fs::path script = ShippedFolder("ED3R_SCRIPTS", "scripts", ED3R_SCRIPTS_DIR) / script_name;
  if (!fs::exists(script))
    return {Drawing::kUnavailable,
            fmt::format("{} is not there; set ED3R_SCRIPTS to its folder", script.string())};
  // Scripts write by name and through links; here nobody else has put any.
  const TemporaryFolder work(folder);
  for (const char* data : {"data.json", "fit.json", "rows.csv", "flights.csv"})
    if (const fs::path file = fs::path(folder) / data; fs::is_regular_file(file))
      fs::copy_file(file, work.path() / data);
  const fs::path errors = work.path() / "plot.log", log = fs::path(folder) / "plot.log";
  const int status = RunProgram({python, "-B", script.string(), work.path().string()}, errors);
  TakePictures(work.path(), folder);
  std::string said, ignored;
  TryReadFile(errors.string(), kMaxTextBytes, said, ignored);
  const std::string last = LastLine(said);
  if (status != 0 && status != kNoMatplotlib && status > 0) {
    WriteFile(log, said);
    return {Drawing::kFailed,
            fmt::format("{} ({}; all of it in {})", last.empty() ? WhyNoMessage(status) : last,
                        script.string(), log.string())};
  }
  std::error_code none;
  fs::remove(log, none);  // of an earlier drawing that failed
  if (status == -ENOENT || status == -EACCES)
    return {Drawing::kUnavailable, fmt::format("{}: {}; set ED3R_PYTHON", python, std::strerror(-status))};
  if (status < 0) return {Drawing::kFailed, fmt::format("{}: {}", python, std::strerror(-status))};
  if (status == kNoMatplotlib) return {Drawing::kUnavailable, last};
  return {};
}

}  // namespace ed3r::figures
