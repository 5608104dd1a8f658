#include "engine/core/files/new_folder.h"

#include "engine/core/files/file.h"

namespace ed3r {

namespace fs = std::filesystem;

NewFolder::NewFolder(const fs::path& folder) {
  std::error_code error;
  fs::path path = fs::absolute(folder).lexically_normal();
  if (!path.has_filename()) path = path.parent_path();
  for (; path.has_filename() && !fs::exists(fs::symlink_status(path, error)); path = path.parent_path())
    made_.push_back(path);
  MakeFolder(folder);
}

NewFolder::~NewFolder() {
  for (const fs::path& path : made_) {
    std::error_code error;  // what is not empty stays, and so does all above it
    if (!fs::is_directory(path, error) || !fs::remove(path, error)) return;
  }
}

}  // namespace ed3r
