// Crowns and trunks that nobody measured, from the height of the tree. H in m:
//
//   crown diameter, m   conifers   3.75105 - 0.17919 H + 0.01241 H^2    (fitted to pines)
//                       deciduous  3.09632 + 0.00895 H^2
//                       mixed      2.51503 + 0.00901 H^2
//     S. C. Popescu, R. H. Wynne: Seeing the trees in the forest. Photogrammetric Engineering & Remote Sensing 70(5),
//     589-604, 2004. Parabolas run away: above kTallestM the crown stays as wide as there (our choice), and no crown is
//     wider than its tree is high.
//   crown area, m^2     tropical   0.156766 H^1.888
//   crown depth, m      all        0.3106775 H^1.098
//     L. Poorter, L. Bongers, F. Bongers: Architecture of 54 moist-forest tree species. Ecology 87(5), 1289-1301, 2006.
//     The depth was measured in moist tropical forest; of other forests it is the best that needs the height alone.
//   trunk diameter at breast height, cm, from height and crown diameter C:  0.557 (H C)^0.809 exp(0.056^2 / 2)
//     T. Jucker et al.: Allometric equations for integrating remote sensing imagery into forest monitoring programmes.
//     Global Change Biology 23(1), 177-190, 2017; over all biomes.
#pragma once

#include <optional>
#include <string_view>

namespace ed3r::world {

enum class ForestKind { kConifers, kDeciduous, kMixed, kTropical };

inline constexpr double kTallestM = 30.0;

std::optional<ForestKind> FindForestKind(std::string_view name);
std::string_view NameOf(ForestKind kind);       // conifers, deciduous, mixed, tropical
std::string_view CrownSource(ForestKind kind);  // "Popescu and Wynne 2004"

double CrownRadiusM(ForestKind kind, double height_m);
double CrownDepthM(double height_m);  // less than the height
double BreastHeightDiameterM(double height_m, double crown_radius_m);

}  // namespace ed3r::world
