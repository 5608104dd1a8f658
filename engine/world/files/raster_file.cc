#include "engine/world/files/raster_file.h"

#include <fmt/format.h>
#include <gdal_priv.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <limits>

#include "engine/core/check.h"
#include "engine/core/files/file.h"
#include "engine/world/files/quiet_gdal.h"
#include "engine/world/files/raster_neighbours.h"
#include "engine/world/files/text_grid.h"

namespace ed3r::world {
namespace {

// What programs write where nothing is known. None is a height of ground on which trees burn.
bool IsUsualMark(double value, GDALDataType type) {
  for (const double mark : {-32768.0, -32767.0, -9999.0, -99999.0, -999999.0, -999.0})
    if (value == mark) return true;
  if (type == GDT_Int16 && value == std::numeric_limits<std::int16_t>::max()) return true;
  if (type == GDT_UInt16 && value == std::numeric_limits<std::uint16_t>::max()) return true;
  // Written as text, the largest float is rounded: -3.4e+38, -3.402823e+38.
  constexpr double kLargest = std::numeric_limits<float>::max();
  return std::abs(value) > 0.99 * kLargest && std::abs(value) < 1.01 * kLargest;
}

// A text's number in GDAL's type: that of its NODATA, and the same as in a GeoTIFF made from it.
double AsGdalKeepsIt(double height, GDALDataType type) {
  constexpr double kLargest = std::numeric_limits<float>::max();
  if (type == GDT_Float32) return static_cast<float>(std::clamp(height, -kLargest, kLargest));
  return type == GDT_Int32 ? height + 0.0 : height;  // whole numbers have no -0
}

}  // namespace

// The session comes before the dataset and goes after it.
class RasterFile::Gdal {
 public:
  QuietGdal quiet;
  struct Closer {
    void operator()(GDALDataset* dataset) const { GDALClose(dataset); }
  };
  std::unique_ptr<GDALDataset, Closer> dataset;
  std::unique_ptr<GDALDataset, Closer>
      alone;  // a GeoTIFF without the .aux.xml beside it, where one stands there
};

RasterFile::RasterFile(const GridTerrainSpec& spec) : spec_(spec), gdal_(std::make_unique<Gdal>()) {
  static constexpr const char* kDrivers[] = {"AAIGrid", "GTiff", nullptr};
  if (const std::string why = WhyNoRegularFile(spec.file); !why.empty()) Fail("cannot be read: " + why);
  // The absolute path: GDAL takes names with certain beginnings for other things than files.
  const auto [file, problem] = NameWithNeighbours(spec.file);
  if (!problem.empty()) Fail(problem);
  file_ = file.string();
  gdal_->dataset.reset(
      GDALDataset::Open(file.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR, kDrivers));
  dataset_ = gdal_->dataset.get();
  if (dataset_ == nullptr) FailToOpen();
  CheckComplaints();
  CheckBands();
  band_ = dataset_->GetRasterBand(1);
  OpenAlone();
  CheckTransform();
  units_ = UnitsOf(*dataset_, gdal_->alone ? gdal_->alone->GetSpatialRef() : nullptr, file, spec);
  cell_x_m_ *= units_.length.m;
  cell_y_m_ *= units_.length.m;
  CheckBlocks();
  ReadCoding();
  CheckComplaints();
}

RasterFile::~RasterFile() = default;

void RasterFile::Fail(const std::string& problem) const {
  FailAt(spec_.file_place, fmt::format("terrain.grid.file: '{}': {}", spec_.file, problem));
}

void RasterFile::FailToOpen() const {
  const std::string error = QuietGdal::LastError();
  const auto says = [&](const char* words) { return error.find(words) != std::string::npos; };
  std::string mend;
  if (says("find data values"))  // so it says where the first lines of heights begin with nan
    mend = "; write a number where its heights begin, and no letter: NODATA_value -9999, and -9999 for nan";
  else if (says("not recognized"))
    mend = "; a text grid must begin with 'ncols', without a byte order mark, blank or line before it";
  Fail(fmt::format("not readable as an ESRI ASCII grid or a GeoTIFF ({}){}", error, mend));
}

// GDAL goes on without what it could not read: a scale, a unit, a coordinate system, a part of the heights.
void RasterFile::CheckComplaints() const {
  const std::string& complaint = gdal_->quiet.Complaint();
  if (complaint.empty()) return;
  const bool no_database = complaint.find("proj.db") != std::string::npos;
  Fail(fmt::format("not read as it stands ({}); {}", complaint,
                   no_database
                       ? "PROJ needs its own database to know coordinate systems: install proj-data, or "
                         "unset PROJ_DATA and PROJ_LIB"
                       : "mend the file (gdalinfo shows more), or write it anew (gdal_translate)"));
}

// GDAL prefers the .aux.xml to what a GeoTIFF says itself, and says nothing of it.
void RasterFile::OpenAlone() {
  static constexpr const char* kDrivers[] = {"GTiff", nullptr};
  is_text_ = dataset_->GetDriver() != nullptr && EQUAL(dataset_->GetDriver()->GetDescription(), "AAIGrid");
  std::error_code error;
  if (is_text_ || !std::filesystem::exists(file_ + ".aux.xml", error)) return;
  const QuietGdal quiet;  // what it complains of was said before
  CPLSetThreadLocalConfigOption("GDAL_PAM_ENABLED", "NO");
  gdal_->alone.reset(GDALDataset::Open(file_.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY, kDrivers));
  std::array<double, 6> unused;
  if (gdal_->alone) gdal_->alone->GetGeoTransform(unused.data());  // GDAL looks for an .aux.xml only now
}

// One page with one band of heights, and perhaps a band that says where they are. Overviews and masks are no pages.
void RasterFile::CheckBands() {
  if (char** const pages = dataset_->GetMetadata("SUBDATASETS"); CSLCount(pages) > 0)
    Fail(fmt::format(
        "{} pages; an elevation grid has one: take one out (gdal_translate GTIFF_DIR:1:'{}' one.tif)",
        CSLCount(pages) / 2, std::filesystem::path(spec_.file).filename().string()));
  const int bands = dataset_->GetRasterCount();
  const bool with_alpha = bands == 2 && dataset_->GetRasterBand(2)->GetColorInterpretation() == GCI_AlphaBand;
  if (with_alpha) mask_ = dataset_->GetRasterBand(2);  // GDAL takes it for a mask where it is of bytes
  if (bands != 1 && !with_alpha) Fail(fmt::format("{} bands; an elevation grid has one", bands));
  GDALRasterBand& band = *dataset_->GetRasterBand(1);
  if (GDALDataTypeIsComplex(band.GetRasterDataType())) Fail("complex numbers; allowed: heights");
  if (band.GetColorTable() != nullptr) Fail("a picture (its band has a colour table); allowed: heights");
}

void RasterFile::CheckTransform() {
  std::array<double, 6> transform;  // x = t0 + t1 column + t2 row, y = t3 + t4 column + t5 row
  if (dataset_->GetGeoTransform(transform.data()) != CE_None) Fail("no cell size (not georeferenced)");
  if (!std::all_of(transform.begin(), transform.end(), [](double t) { return std::isfinite(t); }))
    Fail("its cell size or place is not a finite number");
  if (transform[2] != 0.0 || transform[4] != 0.0 || transform[1] <= 0.0 || transform[5] == 0.0)
    Fail("rotated; allowed: rows from west to east");
  cell_x_m_ = transform[1];
  cell_y_m_ = std::abs(transform[5]);
  north_up_ = transform[5] < 0.0;
  columns_ = dataset_->GetRasterXSize();
  rows_ = dataset_->GetRasterYSize();
  CheckAuxXml(transform);
  if (!is_text_) CheckWorldFiles();
}

// Where the raster lies does not matter, as the area's place is told from its corner.
void RasterFile::CheckAuxXml(const std::array<double, 6>& transform) const {
  constexpr double kRounded = 1e-4;
  std::array<double, 6> own;
  if (!gdal_->alone || gdal_->alone->GetGeoTransform(own.data()) != CE_None) return;
  for (const std::size_t i : {1, 2, 4, 5})
    if (!(std::abs(transform[i] - own[i]) <= kRounded * cell_x_m_))
      Fail(fmt::format(
          "its cells are {:g} x {:g}, and {:g} x {:g} by the .aux.xml beside it; correct it, or take it away",
          own[1], own[5], transform[1], transform[5]));
}

// GDAL takes the cells that the file tells itself, and says nothing of others beside it.
void RasterFile::CheckWorldFiles() const {
  constexpr double kRounded = 1e-4;
  const auto differ = [](double a, double b) { return std::abs(std::abs(a) - b) > kRounded * b; };
  for (const char* ending : {"tfw", "tifw", "wld"}) {
    std::array<double, 6> beside;
    if (!GDALReadWorldFile(file_.c_str(), ending, beside.data())) continue;
    if (differ(beside[1], cell_x_m_) || differ(beside[5], cell_y_m_))
      Fail(fmt::format(
          "its cells are {:g} x {:g}, and {:g} x {:g} by the .{} beside it; correct it, or take it away",
          cell_x_m_, cell_y_m_, std::abs(beside[1]), std::abs(beside[5]), ending));
  }
}

// GDAL reads whole blocks, whose size the file tells.
void RasterFile::CheckBlocks() const {
  int block_columns = 0, block_rows = 0;
  band_->GetBlockSize(&block_columns, &block_rows);
  if (columns_ < 2 || rows_ < 2 || static_cast<double>(block_columns) * block_rows > kMaxWindowCells)
    Fail(
        fmt::format("{} x {} cells in blocks of {} x {}; allowed: at least 2 x 2, blocks of up to {:g} cells",
                    columns_, rows_, block_columns, block_rows, kMaxWindowCells));
}

void RasterFile::ReadCoding() {
  int told = 0;
  if (const double scale = band_->GetScale(&told); told != 0) scale_ = scale;
  if (const double offset = band_->GetOffset(&told); told != 0) offset_ = offset;
  if (!std::isfinite(scale_) || scale_ == 0.0 || !std::isfinite(offset_))
    Fail(fmt::format(
        "its heights are {:g} times the stored number and {:g}; allowed: a finite scale other than 0", scale_,
        offset_));
  // Before 3.7 GDAL had no such type, and gives what is stored as 0 .. 255.
  const char* const pixels = band_->GetMetadataItem("PIXELTYPE", "IMAGE_STRUCTURE");
  signed_bytes_ = band_->GetRasterDataType() == GDT_Byte && pixels != nullptr && EQUAL(pixels, "SIGNEDBYTE");
  const int flags = band_->GetMaskFlags();
  const bool masked = (flags & (GMF_ALL_VALID | GMF_NODATA)) == 0;  // NODATA values are compared here
  if (mask_ == nullptr && masked) mask_ = band_->GetMaskBand();
  CheckMask();
}

// GDAL passes over a mask that it does not understand.
void RasterFile::CheckMask() const {
  if (const std::string beside = MaskBeside(file_); mask_ == nullptr && !beside.empty())
    Fail(
        fmt::format("beside it stands {}, which is no mask that can be read; allowed: a GeoTIFF as GDAL "
                    "writes masks; mend "
                    "it, or take it away",
                    beside));
  if (mask_ == nullptr || (mask_->GetXSize() == columns_ && mask_->GetYSize() == rows_)) return;
  Fail(fmt::format("its mask has {} x {} cells; allowed: as many as its heights, {} x {}", mask_->GetXSize(),
                   mask_->GetYSize(), columns_, rows_));
}

std::vector<double> RasterFile::Read(const CellWindow& window) const {
  const std::size_t cells = static_cast<std::size_t>(window.columns) * window.rows;
  std::vector<double> height(cells);
  std::vector<unsigned char> valid(mask_ != nullptr ? cells : 0);
  ReadRows(window, height.data(), valid.data());
  constexpr double kLargestByte = 127.0, kBytes = 256.0;
  if (signed_bytes_)
    for (double& h : height) h -= h > kLargestByte ? kBytes : 0.0;
  MarkMissingBlocks(window, height);
  CheckHoles(window, height, valid);
  CheckMarks(window, height);
  for (double& h : height) h = (scale_ * h + offset_) * units_.height.m;
  CheckHeights(window, height);
  CheckGap(window, height);
  return height;
}

void RasterFile::ReadText(const CellWindow& window, double* raw) const {
  const GDALDataType type = band_->GetRasterDataType();
  const auto keep = [&](std::size_t cell, double height) {
    const int file_row = static_cast<int>(cell / static_cast<std::size_t>(columns_));
    const int column = static_cast<int>(cell % static_cast<std::size_t>(columns_)) - window.first_column;
    const int row = (north_up_ ? rows_ - 1 - file_row : file_row) - window.first_row;
    if (column >= 0 && column < window.columns && row >= 0 && row < window.rows)
      raw[static_cast<std::size_t>(row) * window.columns + column] = AsGdalKeepsIt(height, type);
  };
  const std::string problem = ReadTextGrid(ReadFile(file_, kMaxModelBytes), columns_, rows_, keep);
  if (!problem.empty()) Fail(problem);
}

// In the order of the file.
void RasterFile::ReadRows(const CellWindow& window, double* raw, unsigned char* valid) const {
  if (is_text_) ReadText(window, raw);
  const int top = north_up_ ? rows_ - window.first_row - window.rows : window.first_row;
  for (int file_row = top; file_row < top + window.rows; ++file_row) {
    const int row = (north_up_ ? rows_ - 1 - file_row : file_row) - window.first_row;
    const std::size_t begin = static_cast<std::size_t>(row) * window.columns;
    if (!is_text_ && band_->RasterIO(GF_Read, window.first_column, file_row, window.columns, 1, raw + begin,
                                     window.columns, 1, GDT_Float64, 0, 0) != CE_None)
      Fail(fmt::format("row {} cannot be read ({})", file_row + 1, QuietGdal::LastError()));
    if (mask_ != nullptr && mask_->RasterIO(GF_Read, window.first_column, file_row, window.columns, 1,
                                            valid + begin, window.columns, 1, GDT_Byte, 0, 0) != CE_None)
      Fail(fmt::format("row {} of its mask cannot be read ({})", file_row + 1, QuietGdal::LastError()));
  }
  CheckComplaints();
}

// Blocks that a sparse GeoTIFF leaves out have no heights; GDAL gives 0 for them.
void RasterFile::MarkMissingBlocks(const CellWindow& window, std::vector<double>& raw) const {
  const int left = window.first_column;
  const int top = north_up_ ? rows_ - window.first_row - window.rows : window.first_row;
  const auto is_empty = [&](int x, int y, int columns, int rows) {
    const int status = band_->GetDataCoverageStatus(x, y, columns, rows, GDAL_DATA_COVERAGE_STATUS_DATA);
    return status == GDAL_DATA_COVERAGE_STATUS_EMPTY;
  };
  int block_columns = 0, block_rows = 0;
  band_->GetBlockSize(&block_columns, &block_rows);
  for (int y = top; y < top + window.rows; y += block_rows - y % block_rows)
    for (int x = left; x < left + window.columns; x += block_columns - x % block_columns) {
      if (!is_empty(x, y, 1, 1)) continue;
      const int end_y = std::min(y + block_rows - y % block_rows, top + window.rows);
      const int end_x = std::min(x + block_columns - x % block_columns, left + window.columns);
      for (int file_row = y; file_row < end_y; ++file_row) {
        const int row = (north_up_ ? rows_ - 1 - file_row : file_row) - window.first_row;
        double* const begin = raw.data() + static_cast<std::size_t>(row) * window.columns - left;
        std::fill(begin + x, begin + end_x, std::numeric_limits<double>::quiet_NaN());
      }
    }
}

void RasterFile::CheckHoles(const CellWindow& window, const std::vector<double>& raw,
                            const std::vector<unsigned char>& valid) const {
  int has_no_data = 0;
  // Compared as floats: a header's -3.4e38 is seldom the exact value in the cells.
  const auto no_data = static_cast<float>(band_->GetNoDataValue(&has_no_data));
  std::size_t holes = 0, first = 0;
  for (std::size_t i = raw.size(); i-- > 0;) {
    const bool hole = !std::isfinite(raw[i]) || (has_no_data != 0 && static_cast<float>(raw[i]) == no_data) ||
                      (!valid.empty() && valid[i] == 0);
    holes += hole;
    if (hole) first = i;
  }
  if (holes == 0) return;
  Fail(
      fmt::format("{} of the {} cells that the area needs have no data (NODATA{}), the first at {}; move or "
                  "shrink offset_m and extent_m",
                  holes, raw.size(), valid.empty() ? "" : " or masked", PlaceOf(window, first)));
}

// Holes of a file that does not declare them. 0 is one where all else lies high above it: what programs leave that turn
// or cut a grid.
void RasterFile::CheckMarks(const CellWindow& window, const std::vector<double>& raw) const {
  constexpr double kHighAboveM = 100.0;
  const GDALDataType type = band_->GetRasterDataType();
  const double unit_m = std::abs(scale_) * units_.height.m;
  double lowest = std::numeric_limits<double>::infinity();
  for (const double value : raw)
    if (value != 0.0) lowest = std::min(lowest, value);
  const bool zero_is_mark = offset_ == 0.0 && std::isfinite(lowest) && lowest * unit_m > kHighAboveM;
  const auto is_mark = [&](double value) {
    return (value == 0.0 && zero_is_mark) || IsUsualMark(value, type);
  };
  const auto first = std::find_if(raw.begin(), raw.end(), is_mark);
  if (first == raw.end()) return;
  const auto count = std::count(raw.begin(), raw.end(), *first);
  Fail(fmt::format(
      "{} of the {} cells that the area needs are {:.6g}, the first at {}: holes that it does not declare; "
      "declare them (gdal_translate -a_nodata {:.6g}) and move or shrink offset_m and extent_m",
      count, raw.size(), *first, PlaceOf(window, static_cast<std::size_t>(first - raw.begin())), *first));
}

// From the deepest sea to the highest mountain; what lies beyond is another unit, or a hole that the file does not
// tell of.
void RasterFile::CheckHeights(const CellWindow& window, const std::vector<double>& heights_m) const {
  constexpr double kLowestM = -12000.0, kHighestM = 9000.0;
  for (std::size_t i = 0; i < heights_m.size(); ++i)
    if (const double height_m = spec_.height_scale * heights_m[i];
        !(height_m >= kLowestM && height_m <= kHighestM))
      Fail(fmt::format("a height of {:g} m at {}; allowed, after height_scale: {:g} .. {:g} m", height_m,
                       PlaceOf(window, i), kLowestM, kHighestM));
}

// Ground has heights in between: what lies a cliff away from all of them is a hole or a spike that the file does not tell
// of, whatever number stands in it.
void RasterFile::CheckGap(const CellWindow& window, const std::vector<double>& heights_m) const {
  constexpr double kBinM = 10.0, kCliffM = 150.0,
                   kSteepest = 3.0;  // a cell may be so much higher than the next
  const auto [lowest, highest] = std::minmax_element(heights_m.begin(), heights_m.end());
  const double low_m = *lowest, gap_m = kCliffM + kSteepest * std::max(cell_x_m_, cell_y_m_);
  const auto bin = [&](double height_m) { return static_cast<std::size_t>((height_m - low_m) / kBinM); };
  std::vector<std::size_t> counts(bin(*highest) + 1, 0);
  for (const double height_m : heights_m) ++counts[bin(height_m)];
  std::size_t below = 0, last = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (counts[i] == 0) continue;
    if (static_cast<double>(i - last) * kBinM > gap_m + kBinM) {
      const bool holes = 2 * below < heights_m.size();
      const auto odd = std::find_if(heights_m.begin(), heights_m.end(),
                                    [&](double height_m) { return (bin(height_m) < i) == holes; });
      Fail(fmt::format(
          "{} of the {} cells that the area needs lie more than {:.0f} m {} all others, the first, of {:.6g} "
          "m, at {}: "
          "holes or spikes that it does not declare; mend them (gdal_fillnodata.py) or move or shrink "
          "offset_m and "
          "extent_m",
          holes ? below : heights_m.size() - below, heights_m.size(), gap_m, holes ? "below" : "above", *odd,
          PlaceOf(window, static_cast<std::size_t>(odd - heights_m.begin()))));
    }
    below += counts[i];
    last = i;
  }
}

std::string RasterFile::PlaceOf(const CellWindow& window, std::size_t index) const {
  const int column = window.first_column + static_cast<int>(index % static_cast<std::size_t>(window.columns));
  const int row = window.first_row + static_cast<int>(index / static_cast<std::size_t>(window.columns));
  return fmt::format("[{:g}, {:g}] m from the south-west cell", column * cell_x_m_, row * cell_y_m_);
}

std::vector<std::string> RasterFile::Files() const {
  std::vector<std::string> files = {file_};
  const auto add = [&](const std::string& file) {
    const bool overviews = std::filesystem::path(file).extension() == ".ovr";  // never read
    if (!file.empty() && !overviews && std::find(files.begin(), files.end(), file) == files.end())
      files.push_back(file);
  };
  char** const list = dataset_->GetFileList();
  for (char** name = list; name != nullptr && *name != nullptr; ++name) add(*name);
  CSLDestroy(list);
  add(units_.prj_file);
  return files;
}

std::string RasterFile::Note() const {
  std::string note;
  const auto add = [&](const std::string& words) {
    note += (note.empty() ? "elevation grid: " : ", ") + words;
  };
  if (units_.length.m != 1.0) add(fmt::format("lengths in {}", units_.length.name));
  if (units_.height.m != 1.0) add(fmt::format("heights in {}", units_.height.name));
  if (scale_ != 1.0 || offset_ != 0.0)
    add(fmt::format("heights are {:g} times what is stored, and {:g}", scale_, offset_));
  // Programs write them as metadata of the band alone; so does GDAL, of heights that were unpacked.
  const auto compare = [&](const char* name, double applied) {
    constexpr double kRounded = 1e-6;
    const char* const text = band_->GetMetadataItem(name);
    const double said = text == nullptr ? applied : CPLAtof(text);
    if (std::abs(said - applied) > kRounded * std::abs(applied))
      add(fmt::format("{} {:g} in its metadata is not applied", name, said));
  };
  compare("scale_factor", scale_);
  compare("add_offset", offset_);
  if (band_->GetRasterDataType() == GDT_Byte && !signed_bytes_)
    add("heights of 8 bits, 0 .. 255 (a hillshade or another picture would look so, and is none)");
  return note;
}

}  // namespace ed3r::world
