#include "engine/world/quiet_gdal.h"

#include <cpl_conv.h>
#include <cpl_error.h>
#include <cpl_string.h>
#include <cpl_vsi_virtual.h>
#include <gdal_frmts.h>
#include <gdal_priv.h>
#include <ogr_srs_api.h>

#include <algorithm>
#include <cerrno>
#include <mutex>
#include <string_view>
#include <vector>

namespace ed3r::world {
namespace {

// In the place of GDAL's virtual file systems: archives, pipes and networks that a file or its metadata could name.
class NoFiles final : public VSIFilesystemHandler {
 public:
  using VSIFilesystemHandler::Open;
  VSIVirtualHandle* Open(const char*, const char*, bool, CSLConstList) override {
    errno = ENOENT;
    return nullptr;
  }
  int Stat(const char*, VSIStatBufL*, int) override {
    errno = ENOENT;
    return -1;
  }
};

// Only files of the disk stay, and parts of them.
void CloseVirtualFileSystems() {
  // GDAL lets go of what it had; some serve two prefixes, so nobody may delete them, and who looks for leaks finds them here.
  static auto* const replaced = new std::vector<VSIFilesystemHandler*>;
  char** const prefixes = VSIGetFileSystemsPrefixes();
  for (char** prefix = prefixes; prefix != nullptr && *prefix != nullptr; ++prefix) {
    const std::string_view name(*prefix);
    if (!name.starts_with("/vsi") || name == "/vsimem/" || name == "/vsisubfile/") continue;
    replaced->push_back(VSIFileManager::GetHandler(*prefix));
    // GDAL keeps it to the end. NOLINTNEXTLINE(clang-analyzer-cplusplus.NewDeleteLeaks)
    VSIFileManager::InstallHandler(*prefix, new NoFiles);
  }
  CSLDestroy(prefixes);
}

// Without it a GeoTIFF's vertical coordinate system, and so the unit of its heights, is passed over.
constexpr const char* kReportVertical = "GTIFF_REPORT_COMPD_CS";

}  // namespace

// GDAL prints its errors on stderr unless told otherwise; here they become part of ours.
QuietGdal::QuietGdal() {
  static std::once_flag once;
  std::call_once(once, [] {
    CloseVirtualFileSystems();
    GDALRegister_AAIGrid();
    GDALRegister_GTiff();
    OSRSetPROJEnableNetwork(0);
  });
  CPLPushErrorHandler(CPLQuietErrorHandler);
  CPLErrorReset();
  CPLSetThreadLocalConfigOption(kReportVertical, "YES");
}

QuietGdal::~QuietGdal() {
  CPLSetThreadLocalConfigOption(kReportVertical, nullptr);
  CPLPopErrorHandler();
}

std::string QuietGdal::LastError() {
  std::string text = CPLGetLastErrorMsg();
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text.empty() ? "unknown reason" : text;
}

}  // namespace ed3r::world
