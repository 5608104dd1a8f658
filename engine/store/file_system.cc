#include "engine/store/file_system.h"

#include <fmt/format.h>
#include <sys/vfs.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <string_view>
#include <system_error>

#include "engine/core/check.h"
#include "engine/store/schema.h"

namespace ed3r::store {
namespace {

// Magic numbers of statfs(2) and of the clients' own headers.
constexpr std::uint32_t kShared[] = {
    0x6969,      // NFS
    0x0bd00bd0,  // Lustre
    0x47504653,  // GPFS, Spectrum Scale
    0x19830326,  // BeeGFS
    0x00c36400,  // Ceph
    0xff534d42,  // CIFS
    0xfe534d42,  // SMB2
    0x517b,      // SMB
    0x5346414f,  // AFS
    0x73757245,  // Coda
    0xaad7aaea,  // PanFS
    0x7461636f,  // OCFS2
    0x01161970,  // GFS2
    0x20030528,  // OrangeFS
    0x01021997,  // 9P
    0x65735546,  // FUSE: GlusterFS, WekaFS, s3fs; some are local, and slower so
};

}  // namespace

std::string ResultsFileOf(const std::string& dir) {
  const std::filesystem::path file = std::filesystem::path(dir) / kResultsFile;
  std::error_code error;
  if (!std::filesystem::is_symlink(file, error)) return file.string();
  const std::filesystem::path found = std::filesystem::canonical(file, error);
  return error ? file.string() : found.string();  // a link to nowhere is refused where it is opened
}

std::string PlaceOf(const std::string& dir) {
  const std::string place = std::filesystem::path(ResultsFileOf(dir)).parent_path().string();
  return place.empty() ? dir : place;
}

std::optional<bool> SaidToBeShared() {
  const char* said = std::getenv("ED3R_STORE");
  if (said == nullptr || *said == '\0') return std::nullopt;
  const std::string_view value = said;
  if (value != "local" && value != "shared")
    throw UserError(fmt::format("ED3R_STORE: '{}' is not allowed; allowed: local | shared", value));
  return value == "shared";
}

bool IsSharedFileSystem(const std::string& dir) {
  if (const std::optional<bool> said = SaidToBeShared()) return *said;
  struct statfs found = {};
  if (statfs(dir.c_str(), &found) != 0) throw UserError(fmt::format("{}: {}", dir, std::strerror(errno)));
  const auto type = static_cast<std::uint32_t>(found.f_type);
  return std::find(std::begin(kShared), std::end(kShared), type) != std::end(kShared);
}

}  // namespace ed3r::store
