// A folder for what may still be refused.
#pragma once

#include <filesystem>
#include <vector>

namespace ed3r {

// Makes the folder and those above it where they are missing (MakeFolder); of these, the ones that are empty at the end of
// this object are taken away again. It must outlive the files that are written there.
class NewFolder {
 public:
  explicit NewFolder(const std::filesystem::path& folder);
  ~NewFolder();
  NewFolder(const NewFolder&) = delete;
  NewFolder& operator=(const NewFolder&) = delete;

 private:
  std::vector<std::filesystem::path> made_;  // the innermost first
};

}  // namespace ed3r
