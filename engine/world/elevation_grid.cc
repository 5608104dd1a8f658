#include <cpl_error.h>
#include <cpl_string.h>
#include <cpl_vsi_virtual.h>
#include <fmt/format.h>
#include <gdal_frmts.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/check.h"
#include "engine/core/file.h"
#include "engine/world/terrain.h"

namespace ed3r {
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
  char** const prefixes = VSIGetFileSystemsPrefixes();
  for (char** prefix = prefixes; prefix != nullptr && *prefix != nullptr; ++prefix) {
    const std::string_view name(*prefix);
    if (name.starts_with("/vsi") && name != "/vsimem/" && name != "/vsisubfile/")
      VSIFileManager::InstallHandler(*prefix, new NoFiles);  // GDAL keeps it to the end
  }
  CSLDestroy(prefixes);
}

// GDAL prints its errors on stderr unless told otherwise; here they become part of ours.
class QuietGdal {
 public:
  QuietGdal() {
    static std::once_flag once;
    std::call_once(once, [] {
      CloseVirtualFileSystems();
      GDALRegister_AAIGrid();
      GDALRegister_GTiff();
    });
    CPLPushErrorHandler(CPLQuietErrorHandler);
    CPLErrorReset();
  }
  ~QuietGdal() { CPLPopErrorHandler(); }
  QuietGdal(const QuietGdal&) = delete;
  QuietGdal& operator=(const QuietGdal&) = delete;

  static std::string LastError() {
    std::string text = CPLGetLastErrorMsg();
    std::replace(text.begin(), text.end(), '\n', ' ');
    return text.empty() ? "unknown reason" : text;
  }
};

// GDAL looks for georeferences and masks in files that are called alike; opening a pipe among them would wait.
std::string WaitingSibling(const std::filesystem::path& file) {
  const std::string stem = file.stem().string();
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(file.parent_path(), error)) {
    const std::string name = entry.path().filename().string();
    const auto kind = entry.status(error).type();
    using Kind = std::filesystem::file_type;
    if (name.starts_with(stem) && (kind == Kind::fifo || kind == Kind::socket || kind == Kind::character))
      return name;
  }
  return "";
}

struct DatasetCloser {
  void operator()(GDALDataset* dataset) const { GDALClose(dataset); }
};
using DatasetPtr = std::unique_ptr<GDALDataset, DatasetCloser>;

bool IsGridNumber(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc() && end == word.data() + word.size() && !std::isinf(value);
}

bool IsHeaderName(std::string_view word) {
  constexpr std::array<std::string_view, 10> kNames = {"ncols",     "nrows",       "xllcorner", "yllcorner",
                                                       "xllcenter", "yllcenter",   "cellsize",  "dx",
                                                       "dy",        "nodata_value"};
  std::string lower(word);
  std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return std::tolower(c); });
  return std::find(kNames.begin(), kNames.end(), lower) != kNames.end();
}

constexpr double kMaxWindowCells = 6e7;  // half a gigabyte

// A rectangle of cells, row 0 in the south, that covers what the area needs.
struct Window {
  int first_column, first_row, columns, rows;
};

class ElevationGrid {
 public:
  explicit ElevationGrid(const GridTerrainSpec& spec) : spec_(spec) {
    static constexpr const char* kDrivers[] = {"AAIGrid", "GTiff", nullptr};
    if (const std::string why = WhyNoRegularFile(spec.file); !why.empty()) Fail("cannot be read: " + why);
    // The absolute path: GDAL takes names with certain beginnings for other things than files.
    const std::filesystem::path file = std::filesystem::canonical(spec.file);
    if (const std::string sibling = WaitingSibling(file); !sibling.empty())
      Fail(fmt::format("beside it stands {}, which is no file", sibling));
    dataset_.reset(
        GDALDataset::Open(file.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR, kDrivers));
    if (!dataset_)
      Fail(fmt::format("not readable as an ESRI ASCII grid or a GeoTIFF ({})", QuietGdal::LastError()));
    CheckKind();
    if (in_order_) CheckWords(file);
  }

  // The terrain's node (x, y) lies at offset + (x, y) * extent / size of the grid.
  Terrain Sample(const Eigen::Vector3d& size_m, double cell_m) {
    CheckExtent();
    CheckCells();
    Terrain terrain = FlatTerrain(size_m, cell_m);
    const double columns_per_node = spec_.extent_m.x() / (terrain.columns - 1) / cell_x_m_;
    const double rows_per_node = spec_.extent_m.y() / (terrain.rows - 1) / cell_y_m_;
    const double first_column = spec_.offset_m.x() / cell_x_m_;
    const double first_row = spec_.offset_m.y() / cell_y_m_;
    ReadWindow({first_column, first_row}, {first_column + columns_per_node * (terrain.columns - 1),
                                           first_row + rows_per_node * (terrain.rows - 1)});
    for (int row = 0; row < terrain.rows; ++row)
      for (int column = 0; column < terrain.columns; ++column)
        terrain.height_m[static_cast<std::size_t>(row) * terrain.columns + column] =
            static_cast<float>(spec_.height_scale * Height(first_column + columns_per_node * column,
                                                           first_row + rows_per_node * row));
    return terrain;
  }

 private:
  [[noreturn]] void Fail(const std::string& problem) const {
    FailAt(spec_.file_place, fmt::format("terrain.grid.file: '{}': {}", spec_.file, problem));
  }

  void CheckKind() {
    if (dataset_->GetRasterCount() != 1)
      Fail(fmt::format("{} bands; an elevation grid has one", dataset_->GetRasterCount()));
    std::array<double, 6> transform;  // x = t0 + t1 column + t2 row, y = t3 + t4 column + t5 row
    if (dataset_->GetGeoTransform(transform.data()) != CE_None) Fail("no cell size (not georeferenced)");
    if (!std::all_of(transform.begin(), transform.end(), [](double t) { return std::isfinite(t); }))
      Fail("its cell size or place is not a finite number");
    if (transform[2] != 0.0 || transform[4] != 0.0 || transform[1] <= 0.0 || transform[5] == 0.0)
      Fail("rotated; allowed: rows from west to east");
    const OGRSpatialReference* reference = dataset_->GetSpatialRef();
    if (reference != nullptr && reference->IsGeographic())
      Fail("in degrees; allowed: a projected grid in metres (gdalwarp -t_srs)");
    cell_x_m_ = transform[1];
    cell_y_m_ = std::abs(transform[5]);
    north_up_ = transform[5] < 0.0;
    columns_ = dataset_->GetRasterXSize();
    rows_ = dataset_->GetRasterYSize();
    in_order_ = dataset_->GetDriver() != nullptr && EQUAL(dataset_->GetDriver()->GetDescription(), "AAIGrid");
    // GDAL reads whole blocks, whose size the file tells.
    int block_columns = 0, block_rows = 0;
    dataset_->GetRasterBand(1)->GetBlockSize(&block_columns, &block_rows);
    if (columns_ < 2 || rows_ < 2 || static_cast<double>(block_columns) * block_rows > kMaxWindowCells)
      Fail(fmt::format(
          "{} x {} cells in blocks of {} x {}; allowed: at least 2 x 2, blocks of up to {:g} cells", columns_,
          rows_, block_columns, block_rows, kMaxWindowCells));
  }

  // GDAL takes a word among the heights of a text grid for 0.
  void CheckWords(const std::filesystem::path& file) const {
    const std::string text = ReadFile(file.string(), kMaxModelBytes);
    constexpr std::string_view kSpace = " \t\r\n";
    for (std::size_t begin = text.find_first_not_of(kSpace); begin != std::string::npos;) {
      const std::size_t end = std::min(text.find_first_of(kSpace, begin), text.size());
      const std::string_view word = std::string_view(text).substr(begin, end - begin);
      if (!IsGridNumber(word) && !IsHeaderName(word))
        Fail(fmt::format(
            "line {}: '{}' is no number",
            1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(begin), '\n'), word));
      begin = text.find_first_not_of(kSpace, end);
    }
  }

  // Between cells that are wider apart than the area nothing is known.
  void CheckCells() const {
    const double columns = spec_.extent_m.x() / cell_x_m_, rows = spec_.extent_m.y() / cell_y_m_;
    if (columns >= 1.0 && rows >= 1.0 && (columns + 2) * (rows + 2) <= kMaxWindowCells) return;
    FailAt(spec_.extent_place,
           fmt::format(
               "terrain.grid: '{}' has cells of {:g} x {:g} m; allowed for an extent of [{:g}, {:g}] m: at "
               "least one a side, at most {:g} in all",
               spec_.file, cell_x_m_, cell_y_m_, spec_.extent_m.x(), spec_.extent_m.y(), kMaxWindowCells));
  }

  void CheckExtent() const {
    const double width_m = (columns_ - 1) * cell_x_m_;
    const double depth_m = (rows_ - 1) * cell_y_m_;
    const Eigen::Vector2d needed_m = spec_.offset_m + spec_.extent_m;
    constexpr double kRoundingM = 1e-6;
    if (needed_m.x() <= width_m + kRoundingM && needed_m.y() <= depth_m + kRoundingM) return;
    FailAt(
        spec_.extent_place,
        fmt::format("terrain.grid: '{}' is too small: offset_m + extent_m = [{:g}, {:g}] m; allowed: up to "
                    "[{:g}, {:g}] m ({} x {} cells of {:g} m)",
                    spec_.file, needed_m.x(), needed_m.y(), width_m, depth_m, columns_, rows_, cell_x_m_));
  }

  // Reads the cells between two corners (in cells) and refuses holes in them. Cells outside do not matter: a
  // crop may touch the edge of the grid, or a hole.
  void ReadWindow(const Eigen::Vector2d& low, const Eigen::Vector2d& high) {
    constexpr double kRounding = 1e-9;
    window_.first_column = static_cast<int>(std::floor(low.x() + kRounding));
    window_.first_row = static_cast<int>(std::floor(low.y() + kRounding));
    window_.columns = static_cast<int>(std::ceil(high.x() - kRounding)) - window_.first_column + 1;
    window_.rows = static_cast<int>(std::ceil(high.y() - kRounding)) - window_.first_row + 1;
    // Two of a side at least, for the ground beyond to go on as steep.
    window_.columns = std::max(window_.columns, 2);
    window_.rows = std::max(window_.rows, 2);
    window_.first_column = std::min(window_.first_column, columns_ - window_.columns);
    window_.first_row = std::min(window_.first_row, rows_ - window_.rows);
    height_m_.resize(static_cast<std::size_t>(window_.columns) * window_.rows);
    GDALRasterBand* band = dataset_->GetRasterBand(1);
    ReadRows(*band);
    CheckHoles(*band);
    CheckHeights();
  }

  // In the order of the file. A text grid from its first row on: GDAL finds a row by reading those before it, and where
  // one is missing it would read them again and again.
  void ReadRows(GDALRasterBand& band) {
    const int top = north_up_ ? rows_ - window_.first_row - window_.rows : window_.first_row;
    for (int file_row = in_order_ ? 0 : top; file_row < top + window_.rows; ++file_row) {
      const int row = (north_up_ ? rows_ - 1 - file_row : file_row) - window_.first_row;
      const bool wanted = file_row >= top;
      double unused = 0.0;
      double* into = wanted ? height_m_.data() + static_cast<std::size_t>(row) * window_.columns : &unused;
      const int columns = wanted ? window_.columns : 1;
      if (band.RasterIO(GF_Read, window_.first_column, file_row, columns, 1, into, columns, 1, GDT_Float64, 0,
                        0) != CE_None)
        Fail(fmt::format("row {} cannot be read ({})", file_row + 1, QuietGdal::LastError()));
    }
  }

  std::string PlaceOf(std::size_t index) const {
    const int column = window_.first_column + static_cast<int>(index % window_.columns);
    const int row = window_.first_row + static_cast<int>(index / window_.columns);
    return fmt::format("[{:g}, {:g}] m from the south-west cell", column * cell_x_m_, row * cell_y_m_);
  }

  // From the deepest sea to the highest mountain; what lies beyond is another unit, or a hole that the file does not
  // tell of.
  void CheckHeights() const {
    constexpr double kLowestM = -12000.0, kHighestM = 9000.0;
    for (std::size_t i = 0; i < height_m_.size(); ++i)
      if (const double height_m = spec_.height_scale * height_m_[i];
          !(height_m >= kLowestM && height_m <= kHighestM))
        Fail(fmt::format("a height of {:g} m at {}; allowed, after height_scale: {:g} .. {:g} m", height_m,
                         PlaceOf(i), kLowestM, kHighestM));
  }

  void CheckHoles(GDALRasterBand& band) const {
    int has_no_data = 0;
    // Compared as floats: a header's -3.4e38 is seldom the exact value in the cells.
    const auto no_data = static_cast<float>(band.GetNoDataValue(&has_no_data));
    const auto is_hole = [&](double height) {
      return !std::isfinite(height) || (has_no_data && static_cast<float>(height) == no_data);
    };
    const auto first = std::find_if(height_m_.begin(), height_m_.end(), is_hole);
    if (first == height_m_.end()) return;
    const auto holes = std::count_if(height_m_.begin(), height_m_.end(), is_hole);
    Fail(
        fmt::format("{} of the {} cells that the area needs have no data (NODATA), the first at {}; move or "
                    "shrink offset_m and "
                    "extent_m",
                    holes, height_m_.size(), PlaceOf(static_cast<std::size_t>(first - height_m_.begin()))));
  }

  // Beyond the window the ground goes on as steep as at its edge.
  double CellHeight(int column, int row) const {
    const int last_column = window_.first_column + window_.columns - 1;
    const int last_row = window_.first_row + window_.rows - 1;
    if (column < window_.first_column) return 2.0 * CellHeight(column + 1, row) - CellHeight(column + 2, row);
    if (column > last_column) return 2.0 * CellHeight(column - 1, row) - CellHeight(column - 2, row);
    if (row < window_.first_row) return 2.0 * CellHeight(column, row + 1) - CellHeight(column, row + 2);
    if (row > last_row) return 2.0 * CellHeight(column, row - 1) - CellHeight(column, row - 2);
    return height_m_[static_cast<std::size_t>(row - window_.first_row) * window_.columns +
                     (column - window_.first_column)];
  }

  // Catmull-Rom weights of the cells at -1, 0, 1, 2 for a position t in [0, 1].
  static std::array<double, 4> Weights(double t) {
    return {t * (t * (2.0 - t) - 1.0) / 2.0, (t * t * (3.0 * t - 5.0) + 2.0) / 2.0,
            t * (t * (4.0 - 3.0 * t) + 1.0) / 2.0, t * t * (t - 1.0) / 2.0};
  }

  double Height(double column, double row) const {
    // The last column and row are reached from the cell before them.
    const int west = std::clamp(static_cast<int>(column), window_.first_column,
                                window_.first_column + window_.columns - 2);
    const int south =
        std::clamp(static_cast<int>(row), window_.first_row, window_.first_row + window_.rows - 2);
    const std::array<double, 4> along_x = Weights(column - west);
    const std::array<double, 4> along_y = Weights(row - south);
    double height = 0.0;
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 4; ++i) height += along_y[j] * along_x[i] * CellHeight(west + i - 1, south + j - 1);
    return height;
  }

  const GridTerrainSpec& spec_;
  DatasetPtr dataset_;
  double cell_x_m_ = 0.0, cell_y_m_ = 0.0;
  bool north_up_ = true, in_order_ = false;
  int columns_ = 0, rows_ = 0;
  Window window_{};
  std::vector<double> height_m_;  // of the window, row-major from the south-west
};

}  // namespace

Terrain ReadElevationGrid(const GridTerrainSpec& spec, const Eigen::Vector3d& size_m, double cell_m) {
  const QuietGdal quiet;
  Terrain terrain = ElevationGrid(spec).Sample(size_m, cell_m);
  PutLowestAtZero(terrain);
  return terrain;
}

}  // namespace ed3r
