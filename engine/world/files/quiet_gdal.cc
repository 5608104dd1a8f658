#include "engine/world/files/quiet_gdal.h"

#include <cpl_conv.h>
#include <cpl_error.h>
#include <cpl_string.h>
#include <cpl_vsi_virtual.h>
#include <gdal_frmts.h>
#include <gdal_priv.h>
#include <ogr_srs_api.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <mutex>
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
  for (char** prefix = prefixes; prefix != nullptr && *prefix != nullptr; ++prefix) {
    const std::string_view name(*prefix);
    if (!name.starts_with("/vsi") || name == "/vsimem/" || name == "/vsisubfile/") continue;
    replaced->push_back(VSIFileManager::GetHandler(*prefix));
    // GDAL keeps it to the end. NOLINTNEXTLINE(clang-analyzer-cplusplus.NewDeleteLeaks)
    VSIFileManager::InstallHandler(*prefix, new NoFiles);
  }
  CSLDestroy(prefixes);
}

struct Option {
  const char* name;
  const char* value;
};

// Those that change numbers, masks, units or where they are looked for. All but two as GDAL has them where nobody says
// otherwise: without the first a GeoTIFF's vertical coordinate system, and so the unit of its heights, is passed over;
// without the second a deprecated coordinate system is a warning. One thread, because complaints of others are lost.
constexpr std::array<Option, 18> kOptions = {{{"GTIFF_REPORT_COMPD_CS", "YES"},
                                              {"OSR_USE_NON_DEPRECATED", "NO"},
                                              {"AAIGRID_DATATYPE", ""},
                                              {"GDAL_DISABLE_READDIR_ON_OPEN", "NO"},
                                              {"GDAL_GEOREF_SOURCES", "PAM,INTERNAL,TABFILE,WORLDFILE"},
                                              {"GDAL_NUM_THREADS", "1"},
                                              {"GDAL_PAM_ENABLED", "YES"},
                                              {"GDAL_PAM_MODE", "PAM"},
                                              {"GTIFF_DIRECT_IO", "NO"},
                                              {"GTIFF_ESRI_CITATION", "YES"},
                                              {"GTIFF_HONOUR_NEGATIVE_SCALEY", "NO"},
                                              {"GTIFF_IGNORE_READ_ERRORS", "NO"},
                                              {"GTIFF_IMPORT_FROM_EPSG", "YES"},
                                              {"GTIFF_LINEAR_UNITS", "DEFAULT"},
                                              {"GTIFF_POINT_GEO_IGNORE", "NO"},
                                              {"GTIFF_SRS_SOURCE", ""},
                                              {"GTIFF_VIRTUAL_MEM_IO", "NO"},
                                              {"TIFF_READ_STREAMING", "NO"}}};

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
    OSRSetPROJEnableNetwork(0);
  });
  CPLErrorReset();
  options_before_ = CPLGetThreadLocalConfigOptions();
  for (const Option& option : kOptions) CPLSetThreadLocalConfigOption(option.name, option.value);
  Forgive();  // what its own configuration file was told of
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
