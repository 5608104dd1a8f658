#include "engine/world/files/raster_reference.h"

#include <fmt/format.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <vector>

#include "engine/core/check.h"
#include "engine/core/files/file.h"
#include "engine/core/message.h"
#include "engine/world/files/quiet_gdal.h"
#include "engine/world/files/raster_neighbours.h"
#include "engine/world/files/tiff_directory.h"
#include "engine/world/files/utm_zone.h"

namespace ed3r::world {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr std::uintmax_t kMaxPrjBytes = 1u << 20;

std::string LowerCase(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

// The vertical coordinate system in a text, whatever the kind of WKT, from its name to its closing bracket, or "".
std::string VerticalSystem(const std::string& text) {
  const std::string lower = LowerCase(text);
  const auto begins = [&](std::size_t at) {
    if (at > 0 && (std::isalnum(static_cast<unsigned char>(lower[at - 1])) != 0 || lower[at - 1] == '_'))
      return false;
    for (const std::string_view name : {"vertcs", "vert_cs", "vertcrs", "verticalcrs"}) {
      if (lower.compare(at, name.size(), name) != 0) continue;
      const std::size_t next = lower.find_first_not_of(" \t\r\n", at + name.size());
      if (next != std::string::npos && (lower[next] == '[' || lower[next] == '(')) return true;
    }
    return false;
  };
  constexpr std::size_t kNone = std::string::npos;
  std::size_t begin = kNone;
  int depth = 0;
  bool quoted = false;
  for (std::size_t at = 0; at < text.size(); ++at) {
    quoted = quoted != (text[at] == '"');
    if (quoted) continue;
    if (begin == kNone && begins(at)) begin = at;
    if (begin == kNone) continue;
    depth += text[at] == '[' || text[at] == '(';
    const bool closes = text[at] == ']' || text[at] == ')';
    depth -= closes;
    if (closes && depth == 0) return text.substr(begin, at + 1 - begin);
  }
  return begin == kNone ? "" : text.substr(begin);
}

struct Degrees {
  double longitude, latitude;
};

class Reference {
 public:
  Reference(GDALDataset& dataset, const OGRSpatialReference* own, const std::filesystem::path& file,
            const GridTerrainSpec& spec)
      : dataset_(dataset), file_(file), spec_(spec) {
    dataset.GetGeoTransform(transform_.data());
    if (const OGRSpatialReference* stored = dataset.GetSpatialRef(); stored != nullptr && !stored->IsEmpty())
      system_ = *stored;
    if (const std::string why = WhyBlocksDoNotFit(file); !why.empty()) Fail(why);
    keys_ = ReadGeoKeys(file);
    // A key is compared on its own: GDAL may not have understood it.
    if (own != nullptr && UnitOfKey(keys_, kProjectedUnitsKey).empty())
      CompareLengths(*own, system_, "the .aux.xml beside it");
    ReadPrj();
  }

  RasterUnits Units() {
    CheckKind();
    RasterUnits units;
    units.length = Length();
    units.height = Height(units.length);
    CheckScale(units.length);
    units.prj_file = prj_file_;
    return units;
  }

 private:
  [[noreturn]] void Fail(const std::string& problem) const {
    FailAt(spec_.file_place, fmt::format("terrain.grid.file: '{}': {}", spec_.file, problem));
  }

  // A grid of another kind, made from this one. Holes are declared: what a turned grid leaves open would be 0 m.
  std::string Reprojected(const Degrees& at) const {
    const std::filesystem::path name(spec_.file);
    return fmt::format("gdalwarp -t_srs {} -r cubic -ot Float32 -dstnodata -9999 '{}' '{}_utm.tif'",
                       UtmZone(at.longitude, at.latitude), name.filename().string(), name.stem().string());
  }

  // GDAL reads the .prj of a text grid, but not that of a GeoTIFF with a world file, nor the unit of heights in it, and
  // passes over one that it does not understand.
  void ReadPrj() {
    prj_file_ = PrjBeside(file_);
    if (prj_file_.empty()) return;
    const std::string text = ReadFile(prj_file_, kMaxPrjBytes);
    ReadOldPrj(text);
    ReadVertical(text);
    if (!system_.IsEmpty()) return ComparePrj(text);
    char** lines = CSLTokenizeString2(text.c_str(), "\n", 0);
    const OGRErr error = system_.importFromESRI(lines);
    CSLDestroy(lines);
    if (error != OGRERR_NONE || system_.IsEmpty()) FailPrj();
    system_.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  }

  // One that the GeoTIFF does not need must not say otherwise. What is not understood says nothing.
  void ComparePrj(const std::string& text) const {
    const QuietGdal quiet;
    OGRSpatialReference beside;
    char** lines = CSLTokenizeString2(text.c_str(), "\n", 0);
    const bool understood =
        beside.importFromESRI(lines) == OGRERR_NONE || beside.importFromWkt(text.c_str()) == OGRERR_NONE;
    CSLDestroy(lines);
    if (understood && !system_.IsGeographic())  // degrees are refused with the command that mends them
      CompareLengths(system_, beside, std::filesystem::path(prj_file_).filename().string());
  }

  void CompareLengths(const OGRSpatialReference& own, const OGRSpatialReference& other,
                      const std::string& where) const {
    constexpr double kRounded = 5e-7;  // as a .prj may be; the two kinds of foot are 2e-6 apart
    const LengthWord here = WordOfLengths(own), there = WordOfLengths(other);
    if (here.text.empty() || there.text.empty() || std::abs(here.m - there.m) <= kRounded * here.m) return;
    Fail(fmt::format(
        "its lengths are in {} by its coordinate system, and in {} by {}; correct the one that is "
        "wrong, or take it away",
        here.text, there.text, where));
  }

  struct LengthWord {
    std::string text;  // "m", "us-ft", "degrees"; "" where the system does not tell
    double m;          // 0 for degrees
  };
  static LengthWord WordOfLengths(const OGRSpatialReference& system) {
    if (system.IsGeographic()) return {"degrees", 0.0};
    if (!system.IsProjected()) return {"", 0.0};
    const char* name = nullptr;
    const double metres = system.GetLinearUnits(&name);
    const std::optional<LengthUnit> unit = FindLengthUnit(metres);
    return {
        unit ? std::string(unit->name) : fmt::format("'{}' of {:g} m", name == nullptr ? "" : name, metres),
        metres};
  }

  [[noreturn]] void FailPrj() const {
    Fail(fmt::format(
        "beside it stands {}, which is not understood; allowed: a coordinate system as ESRI writes it",
        std::filesystem::path(prj_file_).filename().string()));
  }

  // GDAL passes over a second system in a row of its own, and over all where the file has one itself.
  void ReadVertical(const std::string& text) {
    const std::string alone = VerticalSystem(text);
    if (alone.empty()) return;
    OGRSpatialReference vertical;
    if (vertical.importFromWkt(alone.c_str()) != OGRERR_NONE || !vertical.IsVertical()) FailPrj();
    prj_height_ = VerticalUnit(vertical);
  }

  // Before WKT: "Zunits FEET", a line of its own.
  void ReadOldPrj(const std::string& text) {
    char** words = CSLTokenizeString2(LowerCase(text).c_str(), " \t\r\n", 0);
    for (int i = 0; words != nullptr && words[i] != nullptr && words[i + 1] != nullptr; ++i)
      if (std::string_view(words[i]) == "zunits" && std::string_view(words[i + 1]) != "no")
        prj_height_ = words[i + 1];
    CSLDestroy(words);
  }

  void CheckKind() const {
    if (system_.IsGeocentric()) Fail("geocentric; allowed: a projected grid");
    if (system_.IsGeographic()) FailDegrees(system_.GetAngularUnits(nullptr) / kDegree);
    // Without a coordinate system: 0.0001 .. 0.01 at a place on the globe are no metres.
    const double cell = std::max(std::abs(transform_[1]), std::abs(transform_[5]));
    const bool on_the_globe = std::abs(transform_[0]) <= 360.0 && std::abs(transform_[3]) <= 90.0;
    if (system_.IsEmpty() && cell < 0.02 && on_the_globe) FailDegrees(1.0);
  }

  [[noreturn]] void FailDegrees(double degrees_per_unit) const {
    const Degrees at{degrees_per_unit * CentreX(), degrees_per_unit * CentreY()};
    Fail(fmt::format("in degrees (cells of {:g}); allowed: a projected grid: {}", transform_[1],
                     Reprojected(at)));
  }

  double CentreX() const { return transform_[0] + transform_[1] * dataset_.GetRasterXSize() / 2.0; }
  double CentreY() const { return transform_[3] + transform_[5] * dataset_.GetRasterYSize() / 2.0; }

  LengthUnit Length() const {
    std::optional<LengthUnit> told;
    if (system_.IsProjected() || system_.IsLocal()) {
      const char* name = nullptr;
      const double metres = system_.GetLinearUnits(&name);
      const std::string_view word = name == nullptr ? "" : name;
      if (system_.IsProjected() || (word != "unknown" && word != "unnamed" && !word.empty())) {
        told = FindLengthUnit(metres);
        if (!told)
          Fail(fmt::format("its lengths are in '{}' of {:g} m; allowed: {}", word, metres,
                           KnownLengthUnits()));
      }
    }
    told = WithLengthKey(told);
    CheckSame(told, spec_.length_unit, "lengths", "length_unit");
    return told ? *told : spec_.length_unit.value_or(LengthUnit{1.0, "m"});
  }

  // Where GDAL does not know a coordinate system it takes metres, whatever the key beside it says.
  std::optional<LengthUnit> WithLengthKey(const std::optional<LengthUnit>& told) const {
    const std::string word = UnitOfKey(keys_, kProjectedUnitsKey);
    if (word.empty()) return told;
    const std::optional<LengthUnit> key = FindLengthUnit(word);
    if (key && (!told || key->name == told->name)) return key;
    Fail(
        fmt::format("its lengths are in {} by its key ProjLinearUnits, and in {} by its coordinate system; "
                    "give it one that "
                    "is known (gdal_edit.py -a_srs EPSG:NUMBER)",
                    word, told ? told->name : "nothing known"));
  }

  void CheckSame(const std::optional<LengthUnit>& told, const std::optional<LengthUnit>& asked,
                 const char* what, const char* key) const {
    if (told && asked && told->name != asked->name)
      Fail(fmt::format("its {} are in {}, terrain.grid.{} says {}; leave {} out", what, told->name, key,
                       asked->name, key));
  }

  // The unit of the band, of the vertical coordinate system, of the GeoTIFF's key, of the old .prj: all that say one must agree.
  LengthUnit Height(const LengthUnit& length) const {
    std::optional<LengthUnit> told;
    const auto hear = [&](const std::string& word) {
      if (word.empty()) return;
      const std::optional<LengthUnit> unit = FindLengthUnit(word);
      if (!unit && !spec_.height_unit)
        Fail(fmt::format(
            "its heights are in '{}', which is unknown; add 'height_unit: m' (or {}) to terrain.grid", word,
            KnownLengthUnits()));
      if (unit && told && told->name != unit->name)
        Fail(
            fmt::format("its heights are in {} here and in {} there (unit of the band, vertical system, key "
                        "VerticalUnits, .prj); correct the one that is wrong",
                        told->name, unit->name));
      if (unit) told = unit;
    };
    hear(dataset_.GetRasterBand(1)->GetUnitType());
    hear(VerticalUnit(system_));
    hear(UnitOfKey(keys_, kVerticalUnitsKey));
    hear(prj_height_);
    CheckSame(told, spec_.height_unit, "heights", "height_unit");
    if (told) return *told;
    if (spec_.height_unit) return *spec_.height_unit;
    AskForNamedUnit();
    if (length.m != 1.0)
      Fail(fmt::format(
          "its lengths are in {0}, and nothing tells the unit of its heights; add 'height_unit: {0}' or "
          "'height_unit: m' to terrain.grid",
          length.name));
    return {1.0, "m"};
  }

  // Nothing is concluded from a band's name or from metadata that speak of a unit: somebody may have converted the
  // heights.
  void AskForNamedUnit() const {
    const char* const name = dataset_.GetRasterBand(1)->GetDescription();
    if (name != nullptr) AskForUnitIn(name, "its band is called");
    for (GDALMajorObject* object :
         {static_cast<GDALMajorObject*>(&dataset_), static_cast<GDALMajorObject*>(dataset_.GetRasterBand(1))})
      AskForUnitIn(*object);
    for (const MetadataUnit& unit : UnitsOfMetadata(spec_.file))
      AskForUnitIn(unit.text, fmt::format("{} beside it has a unit", unit.file));
  }

  // "units=feet" among what programs write down besides.
  void AskForUnitIn(GDALMajorObject& object) const {
    char** const items = object.GetMetadata();
    for (int i = 0; i < CSLCount(items); ++i) {
      const std::string item = items[i], name = item.substr(0, item.find('='));
      if (IsCalledUnit(name))
        AskForUnitIn(item.substr(std::min(name.size() + 1, item.size())),
                     fmt::format("its metadata have {}", name));
    }
  }

  void AskForUnitIn(const std::string& text, const std::string& where) const {
    const std::vector<std::string> units = LengthUnitsIn(text);
    const auto other =
        std::find_if(units.rbegin(), units.rend(), [](const auto& unit) { return unit != "m"; });
    if (other == units.rend()) return;
    const bool feet = *other == "ft" || *other == "us-ft";
    const std::string mend = feet ? "add 'height_unit: ft', 'us-ft' or 'm' to terrain.grid"
                             : FindLengthUnit(*other)
                                 ? fmt::format("add 'height_unit: {}' or 'm' to terrain.grid", *other)
                                 : "convert them (gdal_calc.py), or add 'height_unit: m' to terrain.grid if "
                                   "they are in metres";
    Fail(OneLine(
        fmt::format("{} '{}', and nothing else tells the unit of its heights; {}", where, text, mend)));
  }

  // Of a compound or a vertical coordinate system, or "".
  std::string VerticalUnit(const OGRSpatialReference& system) const {
    if (!system.IsCompound() && !system.IsVertical()) return "";
    const char* const part = system.IsCompound() ? "COMPD_CS|VERT_CS" : "VERT_CS";
    OGRAxisOrientation direction = OAO_Up;
    system.GetAxis(part, 0, &direction);
    if (direction == OAO_Down) Fail("its heights are depths, down from the surface; allowed: heights");
    const char* name = nullptr;
    const double metres = system.GetTargetLinearUnits(part, &name);
    const std::optional<LengthUnit> unit = FindLengthUnit(metres);
    return unit ? std::string(unit->name) : name == nullptr ? "" : name;
  }

  bool IsWebMercator() const {
    const std::string name = LowerCase(system_.GetName() == nullptr ? "" : system_.GetName());
    return name.find("pseudo-mercator") != std::string::npos ||
           name.find("web mercator") != std::string::npos || name.find("web_mercator") != std::string::npos ||
           name.find("auxiliary_sphere") != std::string::npos;
  }

  // Projections of large areas stretch: Web Mercator by 1 / cos(latitude). Measured in the middle of the grid on the
  // ellipsoid of its own system.
  void CheckScale(const LengthUnit& length) const {
    if (!system_.IsProjected()) return;
    const QuietGdal quiet;  // what lies outside of a projection is complained of, and changes no number
    OGRSpatialReference flat = system_;
    if (flat.IsCompound()) flat.StripVertical();
    flat.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    const std::unique_ptr<OGRSpatialReference> globe(flat.CloneGeogCS());
    if (globe == nullptr) return;
    globe->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    const std::unique_ptr<OGRCoordinateTransformation> to_globe(
        OGRCreateCoordinateTransformation(&flat, globe.get()));
    if (to_globe == nullptr) return;
    constexpr double kStepM = 50.0;
    const double step = kStepM / length.m, x = CentreX(), y = CentreY();
    std::array<double, 5> xs{x, x - step, x + step, x, x}, ys{y, y, y, y - step, y + step};
    std::array<int, 5> done{};
    const double radians = globe->GetAngularUnits(nullptr);
    to_globe->Transform(5, xs.data(), ys.data(), nullptr, done.data());
    const bool all = std::all_of(done.begin(), done.end(), [](int ok) { return ok != 0; });
    if (!all || !std::all_of(xs.begin(), xs.end(), [](double v) { return std::isfinite(v); })) {
      if (IsWebMercator()) Fail("in Web Mercator; allowed: a grid whose metres are metres on the ground");
      return;
    }
    const auto ground_m = [&](int from, int to) {
      const double a = globe->GetSemiMajor(), b = globe->GetSemiMinor(), e2 = 1.0 - b * b / (a * a);
      const double latitude = radians * ys[0], s = std::sin(latitude), w2 = 1.0 - e2 * s * s;
      const double north_m = a * (1.0 - e2) / (w2 * std::sqrt(w2)) * radians * (ys[to] - ys[from]);
      const double east_m = a / std::sqrt(w2) * std::cos(latitude) * radians *
                            std::remainder(xs[to] - xs[from], 2.0 * std::numbers::pi / radians);
      return std::hypot(north_m, east_m);
    };
    const double along_x = ground_m(1, 2) / (2.0 * kStepM), along_y = ground_m(3, 4) / (2.0 * kStepM);
    const double error = std::max(std::abs(along_x - 1.0), std::abs(along_y - 1.0));
    if (error <= kMaxScaleError && !IsWebMercator()) return;
    const Degrees at{radians / kDegree * xs[0], radians / kDegree * ys[0]};
    Fail(fmt::format(
        "a metre of '{}' is {:.3g} x {:.3g} m on the ground there; allowed: within {:g} %, not Web "
        "Mercator: {}",
        system_.GetName(), along_x, along_y, 100.0 * kMaxScaleError, Reprojected(at)));
  }

  GDALDataset& dataset_;
  const std::filesystem::path& file_;
  const GridTerrainSpec& spec_;
  std::array<double, 6> transform_{};  // x = t0 + t1 column + t2 row, y = t3 + t4 column + t5 row
  OGRSpatialReference system_;
  std::map<int, int> keys_;  // of a GeoTIFF
  std::string prj_file_, prj_height_;
};

}  // namespace

RasterUnits UnitsOf(GDALDataset& dataset, const OGRSpatialReference* own, const std::filesystem::path& file,
                    const GridTerrainSpec& spec) {
  return Reference(dataset, own, file, spec).Units();
}

std::string PrjBeside(const std::filesystem::path& file) {
  std::error_code error;
  for (const char* ending : {".prj", ".PRJ", ".Prj"}) {
    std::filesystem::path prj = file;
    if (std::filesystem::exists(prj.replace_extension(ending), error)) return prj.string();
  }
  return "";
}

}  // namespace ed3r::world
