#include "studies/report/files.h"

#include <fmt/format.h>

#include <fstream>

#include "engine/core/check.h"

namespace ed3r {

namespace fs = std::filesystem;

void WriteWhole(const fs::path& file, const std::string& text) {
  const fs::path unfinished = file.string() + ".tmp";
  std::ofstream stream(unfinished, std::ios::binary);
  stream << text;
  stream.close();
  std::error_code error;
  if (stream) fs::rename(unfinished, file, error);
  if (!stream || error) throw UserError(fmt::format("{}: cannot be written", file.string()));
}

void MakeFolder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw UserError(fmt::format("{}: cannot be made: {}", folder.string(), error.message()));
}

}  // namespace ed3r
