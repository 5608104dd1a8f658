#include "engine/world/files/tree_allometry.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace ed3r::world {
namespace {

struct Kind {
  ForestKind kind;
  std::string_view name, source;
};

constexpr std::string_view kPopescu = "Popescu and Wynne 2004";

constexpr std::array<Kind, 4> kKinds = {{{ForestKind::kConifers, "conifers", kPopescu},
                                         {ForestKind::kDeciduous, "deciduous", kPopescu},
                                         {ForestKind::kMixed, "mixed", kPopescu},
                                         {ForestKind::kTropical, "tropical", "Poorter et al. 2006"}}};

double CrownDiameterM(ForestKind kind, double height_m) {
  const double h = std::min(height_m, kTallestM);
  switch (kind) {
    case ForestKind::kConifers:
      return 3.75105 - 0.17919 * h + 0.01241 * h * h;
    case ForestKind::kDeciduous:
      return 3.09632 + 0.00895 * h * h;
    case ForestKind::kMixed:
      return 2.51503 + 0.00901 * h * h;
    case ForestKind::kTropical:
      break;
  }
  const double area_m2 = 0.156766 * std::pow(height_m, 1.888);
  return 2.0 * std::sqrt(area_m2 / std::numbers::pi);
}

}  // namespace

std::optional<ForestKind> FindForestKind(std::string_view name) {
  for (const Kind& kind : kKinds)
    if (kind.name == name) return kind.kind;
  return std::nullopt;
}

std::string_view NameOf(ForestKind kind) { return kKinds[static_cast<std::size_t>(kind)].name; }
std::string_view CrownSource(ForestKind kind) { return kKinds[static_cast<std::size_t>(kind)].source; }

double CrownRadiusM(ForestKind kind, double height_m) {
  return 0.5 * std::min(CrownDiameterM(kind, height_m), height_m);
}

double CrownDepthM(double height_m) { return std::min(0.3106775 * std::pow(height_m, 1.098), height_m); }

double BreastHeightDiameterM(double height_m, double crown_radius_m) {
  return 0.01 * 0.557 * std::pow(height_m * 2.0 * crown_radius_m, 0.809) * std::exp(0.056 * 0.056 / 2.0);
}

}  // namespace ed3r::world
