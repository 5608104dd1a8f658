#include "engine/store/restored_files.h"

#include <fmt/format.h>

#include <fstream>

#include "engine/core/check.h"
#include "engine/store/reader.h"

namespace ed3r::store {
namespace {

namespace fs = std::filesystem;

// A name of a file must lead into the folder, whatever somebody wrote into the store.
bool LeadsOut(const fs::path& name) {
  if (name.empty() || name.is_absolute()) return true;
  for (const fs::path& part : name)
    if (part == "..") return true;
  return false;
}

void Write(const fs::path& path, const std::string& content) {
  fs::create_directories(path.parent_path());
  std::ofstream file(path, std::ios::binary);
  file << content;
  if (!file.flush()) throw UserError(fmt::format("{}: cannot be written", path.string()));
}

}  // namespace

RestoredFiles::RestoredFiles(ResultReader& reader)
    : dir_(reader.dir()), places_(reader.StoredRecipe().places) {
  const std::vector<Session> sessions = reader.Sessions();
  if (!sessions.empty() && sessions.back().notes.contains("sweep file"))
    sweep_file_ = sessions.back().notes.at("sweep file");
  const std::vector<InputFile> files = reader.Files();
  for (const InputFile& file : files)
    if (!file.content && too_large_.empty()) too_large_ = file.name;
  if (files.empty() || !too_large_.empty()) return;
  folder_.emplace(fs::temp_directory_path());
  for (const InputFile& file : files) {
    if (LeadsOut(file.name))
      throw UserError(fmt::format("{}: the file is damaged: it keeps a file called '{}'", dir_, file.name));
    Write(folder_->path() / file.name, *file.content);
  }
}

std::string RestoredFiles::PathOf(const std::string& called) const {
  const auto place = places_.find(called);
  if (folder_ && place != places_.end()) return (folder_->path() / place->second).string();
  const fs::path beside = (fs::path(sweep_file_).parent_path() / called).lexically_normal();
  std::error_code error;
  if (!sweep_file_.empty() && fs::is_regular_file(beside, error)) return beside.string();
  throw UserError(too_large_.empty()
                      ? fmt::format("{}: does not keep the file '{}', and '{}' is not there", dir_, called,
                                    beside.string())
                      : fmt::format("{}: '{}' was too large to be kept with the run, and '{}' is not there",
                                    dir_, too_large_, beside.string()));
}

}  // namespace ed3r::store
