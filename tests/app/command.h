// Runs the program as a user would and keeps what it said.
#pragma once

#include <sys/wait.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace ed3r::app {

struct CommandResult {
  int status = -1;
  std::string out;
  std::string err;
};

inline std::string ReadAll(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

// A folder of its own for one test, removed at the end.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "ed3r-test-XXXXXX").string();
    path_ = mkdtemp(pattern.data());
  }
  ~ScratchFolder() { std::filesystem::remove_all(path_); }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  const std::filesystem::path& Path() const { return path_; }

 private:
  std::filesystem::path path_;
};

// `arguments` as a shell would read them; `environment` like "ED3R_SIMD=scalar".
inline CommandResult Ed3r(const std::string& arguments, const std::string& environment = "") {
  const ScratchFolder scratch;
  const std::string line = environment + " " ED3R_BINARY " " + arguments + " >" + (scratch / "out").string() +
                           " 2>" + (scratch / "err").string();
  const int status = std::system(line.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, ReadAll(scratch / "out"), ReadAll(scratch / "err")};
}

}  // namespace ed3r::app
