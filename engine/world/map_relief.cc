#include "engine/world/map_relief.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace ed3r::world {
namespace {

struct ColourStop {
  float share, red, green, blue;
};

// Valley green through meadow and dry grass to bare rock.
constexpr ColourStop kRamp[] = {{0.00f, 118, 150, 104}, {0.20f, 158, 180, 122}, {0.42f, 208, 205, 150},
                                {0.62f, 206, 180, 136}, {0.80f, 176, 150, 126}, {1.00f, 222, 216, 208}};

// Heights on the picture's pixels, smoother than the triangles, which would show as facets.
cv::Mat SmoothHeights(const Terrain& terrain, cv::Size size_px) {
  const cv::Mat nodes(terrain.rows, terrain.columns, CV_32F, const_cast<float*>(terrain.height_m.data()));
  cv::Mat north_up, smooth;
  cv::flip(nodes, north_up, 0);
  cv::resize(north_up, smooth, size_px, 0, 0, cv::INTER_CUBIC);
  cv::GaussianBlur(smooth, smooth, cv::Size(0, 0), 0.35 * size_px.width / terrain.columns);
  return smooth;
}

// Light from the north-west, 45 degrees high, with the relief exaggerated a little; 1 on level ground.
double Shade(double east_slope, double north_slope) {
  constexpr double kExaggeration = 1.2;
  const double east = kExaggeration * east_slope;
  const double north = kExaggeration * north_slope;
  const double lit = (1.0 + (east - north) / std::sqrt(2.0)) / std::sqrt(1.0 + east * east + north * north);
  return std::clamp(0.42 + 0.58 * lit, 0.25, 1.25);
}

}  // namespace

cv::Vec3f ElevationColour(double share) {
  const float s = std::clamp(static_cast<float>(share), 0.0f, 1.0f);
  const auto* upper = std::find_if(std::begin(kRamp) + 1, std::end(kRamp) - 1,
                                   [&](const ColourStop& stop) { return s <= stop.share; });
  const ColourStop& a = *(upper - 1);
  const ColourStop& b = *upper;
  const float t = (s - a.share) / (b.share - a.share);
  return {a.blue + t * (b.blue - a.blue), a.green + t * (b.green - a.green), a.red + t * (b.red - a.red)};
}

double ContourStepM(double highest_m) {
  for (const double step_m : {1.0, 2.0, 5.0, 10.0, 20.0, 50.0})
    if (highest_m <= 12.0 * step_m) return step_m;
  return 100.0;
}

cv::Mat DrawRelief(const Terrain& terrain, cv::Size size_px, double highest_m) {
  const cv::Mat height = SmoothHeights(terrain, size_px);
  const double m_per_px = (terrain.columns - 1) * terrain.cell_m / size_px.width;
  const double step_m = ContourStepM(highest_m);
  cv::Mat picture(size_px, CV_8UC3);
  for (int v = 0; v < size_px.height; ++v) {
    const int above = std::max(v - 1, 0);
    const int below = std::min(v + 1, size_px.height - 1);
    for (int u = 0; u < size_px.width; ++u) {
      const int left = std::max(u - 1, 0);
      const int right = std::min(u + 1, size_px.width - 1);
      const double here = height.at<float>(v, u);
      const double east =
          (height.at<float>(v, right) - height.at<float>(v, left)) / ((right - left) * m_per_px);
      const double north =
          (height.at<float>(above, u) - height.at<float>(below, u)) / ((below - above) * m_per_px);
      cv::Vec3f colour = ElevationColour(here / highest_m) * static_cast<float>(Shade(east, north));
      const auto level = [&](double h) { return static_cast<int>(std::floor(h / step_m)); };
      const int line =
          std::max({level(here), level(height.at<float>(v, right)), level(height.at<float>(below, u))});
      if (level(height.at<float>(v, right)) != level(here) ||
          level(height.at<float>(below, u)) != level(here)) {
        const float ink = line % 5 == 0 ? 0.55f : 0.78f;
        colour *= ink;
      }
      for (int channel = 0; channel < 3; ++channel)
        picture.at<cv::Vec3b>(v, u)[channel] = cv::saturate_cast<unsigned char>(colour[channel]);
    }
  }
  return picture;
}

}  // namespace ed3r::world
