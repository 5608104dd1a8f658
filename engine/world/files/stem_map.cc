#include "engine/world/files/stem_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <unordered_map>
#include <utility>

#include "engine/core/check.h"
#include "engine/world/files/stem_table.h"

namespace ed3r::world {
namespace {

constexpr double kSpotM = 0.01;  // trees nearer than this are at one spot

// Trees as high as a few to two hundred of their diameters; beyond, a unit is not what the column says. Only grown
// ones: a sapling's diameter at breast height is that of its tip.
// Returns what is to be said of a stand that may be so, but seldom is.
std::string CheckSlenderness(const StemTable& table, const std::vector<Stem>& measured,
                             const std::string& file) {
  constexpr double kGrownM = 5.0, kStoutest = 12.0, kSlenderest = 200.0;
  constexpr std::size_t kFewest = 5;
  std::vector<double> slenderness;
  for (const Stem& stem : measured)
    if (stem.height_m > kGrownM) slenderness.push_back(stem.height_m / (2.0 * stem.trunk_radius_m));
  if (slenderness.size() < kFewest) return "";
  const auto middle = slenderness.begin() + static_cast<std::ptrdiff_t>(slenderness.size() / 2);
  std::nth_element(slenderness.begin(), middle, slenderness.end());
  constexpr double kSeldomStouter = 25.0, kSeldomSlenderer = 125.0;
  if (*middle >= kSeldomStouter && *middle <= kSeldomSlenderer) return "";
  if (*middle >= kStoutest && *middle <= kSlenderest)
    return fmt::format("stem map: half of its trees are {} than {:.0f} diameters high, with '{}' in {}: {}",
                       *middle < kSeldomStouter ? "less" : "more", *middle, table.Header(kDiameter),
                       table.Unit(kDiameter),
                       *middle < kSeldomStouter ? "stout trees, or girths in place of diameters"
                                                : "slender trees, or diameters in inches (dbh_in)");
  const bool stout = *middle < kStoutest;
  throw UserError(
      fmt::format("{}: half of its trees are {} than {:.3g} diameters high, with '{}' in {} and '{}' in {}; "
                  "{}: another unit "
                  "(dbh_cm | dbh_mm | dbh_m | dbh_in, height_m | height_ft in forest.stem_map.columns)",
                  file, stout ? "less" : "more", *middle, table.Header(kDiameter), table.Unit(kDiameter),
                  table.Header(kHeight), table.Unit(kHeight),
                  stout ? "diameters in mm?" : "heights in feet, or diameters in inches or m?"));
}

class StemMapBuilder {
 public:
  explicit StemMapBuilder(const StemMapSpec& spec) : spec_(spec), table_(spec) {}

  StemMap Build() {
    if (table_.Rows() == 0) throw UserError(fmt::format("{}: no trees in this stem map", spec_.file));
    for (std::size_t row = 0; row < table_.Rows(); ++row) ReadTree(row);
    const std::string slenderness = CheckSlenderness(table_, measured_, spec_.file);
    FindBounds();
    CheckPlaces();
    CheckSpots();
    FindBounds();  // a tree at the edge may have been left out
    NoteWideStand();
    MoveToOrigin();
    NoteEstimates();
    if (!slenderness.empty()) map_.notes.push_back(slenderness);
    return std::move(map_);
  }

 private:
  void ReadTree(std::size_t row) {
    Stem stem;
    stem.x_m = *table_.Number(row, kX);
    stem.y_m = *table_.Number(row, kY);
    const std::optional<double> diameter_m = table_.Number(row, kDiameter);
    stem.height_m = *table_.Number(row, kHeight);
    const std::optional<double> depth_m = table_.CrownDepth(row, stem.height_m);
    const std::optional<double> radius_m = table_.CrownRadius(row, stem.height_m);
    // Where one is missing, estimate_missing is there: the reader refuses otherwise.
    stem.crown_depth_m = depth_m ? *depth_m : CrownDepthM(stem.height_m);
    stem.crown_radius_m = radius_m ? *radius_m : CrownRadiusM(*spec_.estimate_missing, stem.height_m);
    stem.trunk_radius_m =
        (diameter_m ? *diameter_m : BreastHeightDiameterM(stem.height_m, stem.crown_radius_m)) / 2.0;
    depths_ += !depth_m;
    radii_ += !radius_m;
    diameters_ += !diameter_m;
    if (diameter_m) measured_.push_back(stem);
    map_.stems.push_back(stem);
  }

  // Two rows of one tree (another year, a copied line) would stand inside one another.
  void CheckSpots() {
    const std::vector<Stem>& stems = map_.stems;
    std::unordered_map<std::int64_t, std::vector<std::size_t>>
        standing;  // by squares of a spot's size, without those left out
    std::vector<bool> left_out(stems.size(), false);
    for (std::size_t row = 0; row < stems.size(); ++row) {
      for (const std::int64_t square : SquaresAround(stems[row]))
        std::erase_if(standing[square], [&](std::size_t other) {
          const bool one_spot = std::abs(stems[row].x_m - stems[other].x_m) <= kSpotM &&
                                std::abs(stems[row].y_m - stems[other].y_m) <= kSpotM;
          if (!one_spot || left_out[row]) return false;
          if (!spec_.tallest_of_a_spot) FailSpot(row, other);
          const bool taller = stems[row].height_m > stems[other].height_m;
          left_out[taller ? other : row] = true;
          return taller;
        });
      if (!left_out[row]) standing[SquaresAround(stems[row]).front()].push_back(row);
    }
    const auto count = std::count(left_out.begin(), left_out.end(), true);
    if (count == 0) return;
    map_.notes.push_back(fmt::format("stem map: {} of {} trees left out, each at the spot of a taller one",
                                     count, stems.size()));
    std::size_t row = 0;
    std::erase_if(map_.stems, [&](const Stem&) { return left_out[row++]; });
  }

  // Its own first. Positions are within 1e7 m, so a number of squares fits 32 bits.
  static std::array<std::int64_t, 9> SquaresAround(const Stem& stem) {
    const auto x = static_cast<std::int64_t>(std::floor(stem.x_m / kSpotM)),
               y = static_cast<std::int64_t>(std::floor(stem.y_m / kSpotM));
    std::array<std::int64_t, 9> squares{};
    std::size_t i = 0;
    for (const int dx : {0, -1, 1})
      for (const int dy : {0, -1, 1}) squares[i++] = (x + dx) * (std::int64_t{1} << 32) + (y + dy);
    return squares;
  }

  [[noreturn]] void FailSpot(std::size_t row, std::size_t other) const {
    throw UserError(fmt::format(
        "{}:{}:1: a tree at [{:.10g}, {:.10g}] m, where that of line {} stands; leave one out, or "
        "add 'same_spot: tallest' to forest.stem_map",
        spec_.file, table_.Line(row), map_.stems[row].x_m, map_.stems[row].y_m, table_.Line(other)));
  }

  void FindBounds() {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    low_ = Eigen::Vector2d(kInfinity, kInfinity);
    high_ = -low_;
    for (const Stem& stem : map_.stems) {
      low_ = low_.cwiseMin(Eigen::Vector2d(stem.x_m, stem.y_m));
      high_ = high_.cwiseMax(Eigen::Vector2d(stem.x_m, stem.y_m));
    }
    map_.size_m = high_ - low_;
  }

  // Degrees, and places that nobody measured.
  void CheckPlaces() const {
    constexpr double kMinSideM = 10.0, kMaxSideM = 20000.0;
    const double shorter = map_.size_m.minCoeff(), longer = map_.size_m.maxCoeff();
    const bool on_the_globe = low_.x() >= -180 && high_.x() <= 180 && low_.y() >= -90 && high_.y() <= 90;
    if (longer > 0.0 && longer < 1.0 && on_the_globe)
      table_.FailDegrees(table_.Header(kX), table_.Header(kY));
    if (shorter >= kMinSideM && longer <= kMaxSideM) return;
    throw UserError(fmt::format(
        "{}: the stand measures {:g} x {:g} m; allowed: {}", spec_.file, map_.size_m.x(), map_.size_m.y(),
        shorter < kMinSideM ? fmt::format("at least {:g} m a side", kMinSideM)
                            : fmt::format("up to {:g} m a side; {}", kMaxSideM, FarthestTree())));
  }

  void MoveToOrigin() {
    for (Stem& stem : map_.stems) {
      stem.x_m -= low_.x();
      stem.y_m -= low_.y();
    }
  }

  // From the tree in the middle.
  std::string FarthestTree() const {
    const auto middle = [&](double Stem::*coordinate) {
      std::vector<double> values;
      for (const Stem& stem : map_.stems) values.push_back(stem.*coordinate);
      std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                       values.end());
      return values[values.size() / 2];
    };
    const double x_m = middle(&Stem::x_m), y_m = middle(&Stem::y_m);
    const auto far = [&](const Stem& stem) { return std::hypot(stem.x_m - x_m, stem.y_m - y_m); };
    const Stem& stem = *std::max_element(map_.stems.begin(), map_.stems.end(),
                                         [&](const Stem& a, const Stem& b) { return far(a) < far(b); });
    return fmt::format("farthest away is the tree at [{:.10g}, {:.10g}] m", stem.x_m, stem.y_m);
  }

  // One wrong place, and the stand is kilometres of nothing.
  void NoteWideStand() {
    constexpr double kSparseM2 = 1e4;
    const double m2 = map_.size_m.x() * map_.size_m.y() / static_cast<double>(map_.stems.size());
    if (m2 > kSparseM2)
      map_.notes.push_back(fmt::format("stem map: one tree in {:.3g} ha of a stand of {:.0f} x {:.0f} m; {}",
                                       m2 / kSparseM2, map_.size_m.x(), map_.size_m.y(), FarthestTree()));
  }

  void NoteEstimates() {
    const std::size_t trees = table_.Rows();
    if (radii_ > 0)
      map_.notes.push_back(fmt::format("stem map: crown radius of {} of {} trees from their height ({}: {})",
                                       radii_, trees, NameOf(*spec_.estimate_missing),
                                       CrownSource(*spec_.estimate_missing)));
    if (depths_ > 0)
      map_.notes.push_back(fmt::format(
          "stem map: crown depth of {} of {} trees from their height (Poorter et al. 2006)", depths_, trees));
    if (diameters_ > 0)
      map_.notes.push_back(
          fmt::format("stem map: diameter of {} of {} trees from their height and crown (Jucker et al. 2017)",
                      diameters_, trees));
  }

  const StemMapSpec& spec_;
  StemTable table_;
  StemMap map_;
  Eigen::Vector2d low_, high_;                          // corners of the stand
  std::vector<Stem> measured_;                          // those whose diameter was
  std::size_t depths_ = 0, radii_ = 0, diameters_ = 0;  // estimated
};

}  // namespace

StemMap ReadStemMap(const StemMapSpec& spec) { return StemMapBuilder(spec).Build(); }

}  // namespace ed3r::world
