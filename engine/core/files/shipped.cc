#include "engine/core/files/shipped.h"

#include <cstdlib>
#include <system_error>

namespace ed3r {

namespace fs = std::filesystem;

fs::path ProgramFolder() {
  std::error_code error;
  return fs::read_symlink("/proc/self/exe", error).parent_path();
}

fs::path ShippedFolder(const char* variable, const std::string& name, const std::string& source) {
  const char* value = std::getenv(variable);
  if (value != nullptr && *value != '\0') return value;
  std::error_code error;
  const fs::path installed = ProgramFolder().parent_path() / "share" / "ed3r" / name;
  return fs::is_directory(installed, error) ? installed : fs::path(source);
}

fs::path ShippedSweeps() { return ShippedFolder("ED3R_SWEEPS", "sweeps", ED3R_SWEEPS_DIR); }

}  // namespace ed3r
