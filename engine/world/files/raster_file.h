// A raster of heights as its file has it, read through GDAL (a text grid's heights by text_grid.h) into metres: linear unit, vertical unit, scale and offset
// are applied; cells that a mask, an alpha band or a NODATA value leaves out, or that hold a usual mark for holes, or
// lie far from all other heights, are refused where they are needed.
//
// Only files of the disk are opened (no pipes, archives, networks), and GDAL prints nothing.
// Errors: UserError at the world file's key. Threads: an object belongs to one thread.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "engine/world/files/grid_spec.h"
#include "engine/world/files/raster_reference.h"

class GDALDataset;
class GDALRasterBand;

namespace ed3r::world {

// A rectangle of cells, row 0 in the south.
struct CellWindow {
  int first_column, first_row, columns, rows;
};

constexpr double kMaxWindowCells = 6e7;  // half a gigabyte

class RasterFile {
 public:
  explicit RasterFile(const GridTerrainSpec& spec);
  ~RasterFile();
  RasterFile(const RasterFile&) = delete;
  RasterFile& operator=(const RasterFile&) = delete;

  int columns() const { return columns_; }
  int rows() const { return rows_; }
  double cell_x_m() const { return cell_x_m_; }
  double cell_y_m() const { return cell_y_m_; }

  // Heights in m, row-major from the south-west; not multiplied by height_scale, but what they are then is checked.
  std::vector<double> Read(const CellWindow& window) const;

  // The file and those beside it that it was read with: .prj, .tfw, .aux.xml, .msk.
  std::vector<std::string> Files() const;

  // "elevation grid: lengths in us-ft, heights in ft", or "" where it is in metres as it stands.
  std::string Note() const;

 private:
  class Gdal;

  [[noreturn]] void FailToOpen() const;
  [[noreturn]] void Fail(const std::string& problem) const;
  void CheckComplaints() const;
  void OpenAlone();
  void CheckBands();
  void CheckTransform();
  void CheckAuxXml(const std::array<double, 6>& transform) const;
  void CheckWorldFiles() const;
  void CheckBlocks() const;
  void ReadCoding();
  void CheckMask() const;
  void ReadText(const CellWindow& window, double* raw) const;
  void ReadRows(const CellWindow& window, double* raw, unsigned char* valid) const;
  void MarkMissingBlocks(const CellWindow& window, std::vector<double>& raw) const;
  void CheckHoles(const CellWindow& window, const std::vector<double>& raw,
                  const std::vector<unsigned char>& valid) const;
  void CheckMarks(const CellWindow& window, const std::vector<double>& raw) const;
  void CheckHeights(const CellWindow& window, const std::vector<double>& height_m) const;
  void CheckGap(const CellWindow& window, const std::vector<double>& height_m) const;
  std::string PlaceOf(const CellWindow& window, std::size_t index) const;

  const GridTerrainSpec& spec_;
  std::unique_ptr<Gdal> gdal_;
  GDALDataset* dataset_ = nullptr;
  GDALRasterBand* band_ = nullptr;
  GDALRasterBand* mask_ = nullptr;  // 0 where there is no height; none: all have one, but for NODATA
  std::string file_;                // absolute: the name that its neighbours share
  RasterUnits units_;
  double scale_ = 1.0, offset_ = 0.0;  // height in its unit = scale * value + offset
  bool north_up_ = true, is_text_ = false, signed_bytes_ = false;
  int columns_ = 0, rows_ = 0;
  double cell_x_m_ = 0.0, cell_y_m_ = 0.0;
};

}  // namespace ed3r::world
