#include "engine/world/files/quiet_gdal.h"

#include <cpl_conv.h>
#include <cpl_error.h>
#include <cpl_string.h>
#include <cpl_vsi.h>
#include <cpl_vsi_virtual.h>
#include <gdal_frmts.h>
#include <gdal_priv.h>
#include <ogr_srs_api.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/message.h"

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
  // GDAL keeps each to the end. NOLINTNEXTLINE(clang-analyzer-cplusplus.NewDeleteLeaks)
  for (char** prefix = prefixes; prefix != nullptr && *prefix != nullptr; ++prefix) {
    const std::string_view name(*prefix);
    if (!name.starts_with("/vsi") || name == "/vsimem/" || name == "/vsisubfile/") continue;
    replaced->push_back(VSIFileManager::GetHandler(*prefix));
    VSIFileManager::InstallHandler(*prefix, new NoFiles);
  }
  CSLDestroy(prefixes);
}

// What GDAL is told otherwise than it does by itself: without the first a GeoTIFF's vertical coordinate system, and so the
// unit of its heights, is passed over; without the second a deprecated coordinate system is a warning.
constexpr std::array<const char*, 3> kOptions = {"GTIFF_REPORT_COMPD_CS=YES", "OSR_USE_NON_DEPRECATED=NO",
                                                 nullptr};

// Dozens of variables change numbers, masks, units or where they are looked for, and each release has more: none is heard.
// Called when the drivers are there, which have read the configuration files by then.
void CloseEnvironment() {
  std::string text = "[directives]\nignore-env-vars=yes\n";
  const char* const file = "/vsimem/ed3r.gdalrc";  // the only way to say so
  VSIFCloseL(VSIFileFromMemBuffer(file, reinterpret_cast<GByte*>(text.data()), text.size(), FALSE));
  CPLLoadConfigOptionsFromFile(file, TRUE);
  VSIUnlink(file);
  CPLSetConfigOptions(nullptr);
}

// Said of good files, and of no number in them: units of a coordinate system that is not the registry's are compared with
// the file's keys.
constexpr std::array<std::string_view, 6> kHarmless = {"Unsupported value for AAIGRID_DATATYPE",
                                                       "does not end in null byte",
                                                       "Nonstandard tile",
                                                       "tags are not sorted in ascending order",
                                                       "doesn't match SamplesPerPixel",
                                                       "is not the same as the one from the EPSG registry"};

bool IsHarmless(std::string_view message) {
  return std::any_of(kHarmless.begin(), kHarmless.end(),
                     [&](std::string_view words) { return message.find(words) != std::string_view::npos; });
}

}  // namespace

// GDAL prints its errors on stderr unless told otherwise; here they become part of ours.
QuietGdal::QuietGdal() {
  // Of each variable GDAL says that it is not heard, if CPL_DEBUG wants it said, for which it asks that variable, and says so of
  // it: without end, were it there. Somebody's Python may have set it since.
  unsetenv("CPL_DEBUG");
  CPLPushErrorHandlerEx(
      [](CPLErr kind, CPLErrorNum, const char* message) {
        if (kind == CE_Warning || kind == CE_Failure)
          static_cast<QuietGdal*>(CPLGetErrorHandlerUserData())->Hear(message);
      },
      this);
  static std::once_flag once;
  std::call_once(once, [] {
    CloseVirtualFileSystems();
    GDALRegister_AAIGrid();
    GDALRegister_GTiff();
    CloseEnvironment();
    OSRSetPROJEnableNetwork(0);
  });
  CPLErrorReset();
  options_before_ = CPLGetThreadLocalConfigOptions();
  CPLSetThreadLocalConfigOptions(kOptions.data());
  Forgive();  // what its configuration files were told of
}

QuietGdal::~QuietGdal() {
  CPLSetThreadLocalConfigOptions(options_before_);
  CSLDestroy(options_before_);
  CPLPopErrorHandler();
}

void QuietGdal::Hear(const std::string& message) {
  if (complaint_.empty() && !IsHarmless(message)) complaint_ = OneLine(message);
}

std::string QuietGdal::LastError() {
  std::string text = CPLGetLastErrorMsg();
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text.empty() ? "unknown reason" : text;
}

}  // namespace ed3r::world
