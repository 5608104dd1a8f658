#include "engine/core/files/remove_file.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "engine/core/check.h"

namespace ed3r {

void RemoveFile(const std::filesystem::path& path) {
  if (::unlink(path.c_str()) == 0) return;
  const int error = errno;
  std::error_code ignored;
  if (error == ENOENT || error == ENOTDIR || std::filesystem::is_directory(path, ignored)) return;
  throw UserError(fmt::format("{}: is of an earlier call and cannot be taken away: {}", path.string(),
                              std::strerror(error)));
}

}  // namespace ed3r
