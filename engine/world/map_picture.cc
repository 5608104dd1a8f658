#include "engine/world/map_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "engine/core/check.h"
#include "engine/world/files/picture_file.h"
#include "engine/world/map_relief.h"

namespace ed3r::world {
namespace {

// Everything is drawn at twice the size and shrunk at the end: the simplest good antialiasing.
constexpr int kOversampling = 2;

// The layout is designed for this width and scaled to the one asked for.
constexpr double kDesignWidth = 1200.0;
constexpr double kLeft = 62, kTop = 72, kBottom = 52, kGap = 30, kLegend = 232, kRight = 16;

const cv::Scalar kPaper(248, 250, 250);
const cv::Scalar kInk(48, 44, 40);
const cv::Scalar kFaint(130, 126, 120);
const cv::Scalar kKnownFire(24, 128, 255);
const cv::Scalar kUnseenFire(60, 28, 178);
const cv::Scalar kStation(170, 84, 22);
const cv::Scalar kWhite(255, 255, 255);

class MapPicture {
 public:
  MapPicture(const Scene& scene, const MapOverlay& overlay, int width_px)
      : scene_(scene), overlay_(overlay), scale_(kOversampling * width_px / kDesignWidth) {
    map_width_ = kDesignWidth - kLeft - kGap - kLegend - kRight;
    px_per_m_ = map_width_ / scene.SizeM().x();
    map_height_ = px_per_m_ * scene.SizeM().y();
    height_ = kTop + std::max(map_height_, 640.0) + kBottom;
    canvas_ = cv::Mat(Px(height_), Px(kDesignWidth), CV_8UC3, kPaper);
    const auto& heights = scene.Ground().height_m;
    highest_m_ = std::max(1.0, static_cast<double>(*std::max_element(heights.begin(), heights.end())));
  }

  cv::Mat Draw() {
    DrawTitle();
    const cv::Rect frame(Px(kLeft), Px(kTop), Px(map_width_), Px(map_height_));
    DrawRelief(scene_.Ground(), frame.size(), highest_m_).copyTo(canvas_(frame));
    DrawTrees(frame);
    DrawStart();
    for (const BaseStation& station : scene_.BaseStations())
      DrawStation(OnMap(station.antenna_m.x(), station.antenna_m.y()), station.known, station.name);
    for (std::size_t i = 0; i < scene_.Sites().size(); ++i) {
      if (overlay_.site >= 0 && overlay_.site != static_cast<int>(i)) continue;
      const FireSite& site = scene_.Sites()[i];
      DrawSite(OnMap(site.base_m.x(), site.base_m.y()), site.known, fmt::format("{}", i + 1));
    }
    DrawPath();
    cv::rectangle(canvas_, frame, kInk, Px(1.2), cv::LINE_AA);
    DrawAxes();
    DrawScaleBar();
    DrawLegend();
    cv::Mat small;
    cv::resize(canvas_, small, cv::Size(), 1.0 / kOversampling, 1.0 / kOversampling, cv::INTER_AREA);
    return small;
  }

 private:
  int Px(double design) const { return static_cast<int>(std::lround(design * scale_)); }
  cv::Point At(double x, double y) const { return {Px(x), Px(y)}; }  // design coordinates
  cv::Point2d OnMap(double x_m, double y_m) const {
    return {kLeft + x_m * px_per_m_, kTop + map_height_ - y_m * px_per_m_};
  }

  // align: 0 left, 0.5 centred, 1 right; y is the baseline.
  void Text(const std::string& text, double x, double y, double size, double align = 0.0,
            const cv::Scalar& colour = kInk, double weight = 1.0) {
    constexpr int kFont = cv::FONT_HERSHEY_DUPLEX;
    const double font_scale = size * scale_ / 30.0;
    const int thickness = std::max(1, Px(0.75 * weight));
    int baseline = 0;
    const cv::Size extent = cv::getTextSize(text, kFont, font_scale, thickness, &baseline);
    cv::putText(canvas_, text, {Px(x) - static_cast<int>(align * extent.width), Px(y)}, kFont, font_scale,
                colour, thickness, cv::LINE_AA);
  }

  void Disc(const cv::Point2d& centre, double radius, const cv::Scalar& colour, double thickness = -1.0) {
    cv::circle(canvas_, At(centre.x, centre.y), Px(radius), colour,
               thickness < 0 ? cv::FILLED : Px(thickness), cv::LINE_AA);
  }

  // The flown path with a dot per timestep; the end is ringed.
  void DrawPath() {
    const cv::Scalar halo(255, 255, 255), ink(160, 40, 120);
    std::vector<cv::Point2d> points;
    for (const Eigen::Vector3d& p : overlay_.path_m) points.push_back(OnMap(p.x(), p.y()));
    for (const auto& [colour, width] : {std::pair{halo, 5.0}, std::pair{ink, 2.4}})
      for (std::size_t i = 1; i < points.size(); ++i)
        cv::line(canvas_, At(points[i - 1].x, points[i - 1].y), At(points[i].x, points[i].y), colour,
                 Px(width), cv::LINE_AA);
    for (const cv::Point2d& point : points) Disc(point, 3.4, ink);
    if (points.empty()) return;
    Disc(points.back(), 9, halo, 4.5);
    Disc(points.back(), 9, ink, 2.2);
  }

  void DrawTitle() {
    Text(scene_.Name(), kLeft, 36, 26, 0.0, kInk, 1.6);
    Text(fmt::format("{:g} x {:g} x {:g} m, ground 0 to {:.0f} m, {} trees", scene_.SizeM().x(),
                     scene_.SizeM().y(), scene_.SizeM().z(), highest_m_, scene_.Trees().size()),
         kLeft + map_width_, 36, 14.5, 1.0, kFaint);
  }

  // A crown: its shadow to the south-east, the crown, a lit patch to the north-west.
  void DrawTree(cv::Mat& layer, const cv::Point2d& centre, double radius, double height_m) const {
    const double shadow = 0.12 * height_m * px_per_m_;
    const double tone = std::clamp((height_m - 6.0) / 20.0, 0.0, 1.0);
    const cv::Scalar crown(58 - 18 * tone, 104 - 34 * tone, 72 - 34 * tone);
    const auto disc = [&](double dx, double dy, double r, const cv::Scalar& colour) {
      cv::circle(layer, At(centre.x - kLeft + dx, centre.y - kTop + dy), std::max(1, Px(r)), colour,
                 cv::FILLED, cv::LINE_AA);
    };
    disc(shadow, shadow, 0.9 * radius, cv::Scalar(44, 58, 50));
    disc(0, 0, radius, crown);
    disc(-0.28 * radius, -0.28 * radius, 0.5 * radius, crown + cv::Scalar(16, 26, 20));
  }

  void DrawTrees(const cv::Rect& frame) {
    cv::Mat map = canvas_(frame);
    cv::Mat layer = map.clone();
    for (const Tree& tree : scene_.Trees())
      DrawTree(layer, OnMap(tree.x_m, tree.y_m), tree.crown_radius_m * px_per_m_, tree.height_m);
    cv::addWeighted(layer, 0.8, map, 0.2, 0.0, map);
  }

  void DrawStart() {
    const StartArea& start = scene_.Start();
    if (start.height_max_m <= 0.0) return;
    const cv::Point2d centre = OnMap(start.x_m, start.y_m);
    const double radius = start.radius_m * px_per_m_;
    cv::Mat layer = canvas_.clone();
    cv::circle(layer, At(centre.x, centre.y), Px(radius), kWhite, cv::FILLED, cv::LINE_AA);
    cv::addWeighted(layer, 0.45, canvas_, 0.55, 0.0, canvas_);
    StartRing(centre, radius);
    Text("start", centre.x, centre.y + 5, 14, 0.5, kInk, 1.2);
  }

  void StartRing(const cv::Point2d& centre, double radius) {
    Disc(centre, radius, kInk, 3.2);
    Disc(centre, radius, kWhite, 1.8);
  }

  // A flame: a circle drawn out to a tip.
  void DrawSite(const cv::Point2d& foot, bool known, const std::string& label) {
    constexpr double kRadius = 11.0;
    const auto flame = [&](double grow) {
      std::vector<cv::Point> outline;
      for (int i = 0; i <= 48; ++i) {
        const double angle = 2.0 * CV_PI * i / 48;
        const double towards_tip = std::max(0.0, std::cos(angle));
        const double radius = (kRadius + grow) * (1.0 + 0.85 * std::pow(towards_tip, 6.0));
        const double narrow = 1.0 - 0.25 * std::pow(towards_tip, 2.0);
        outline.push_back(At(foot.x + narrow * radius * std::sin(angle), foot.y - radius * std::cos(angle)));
      }
      return outline;
    };
    cv::fillPoly(canvas_, std::vector{flame(2.6)}, kInk, cv::LINE_AA);
    cv::fillPoly(canvas_, std::vector{flame(1.6)}, kWhite, cv::LINE_AA);
    cv::fillPoly(canvas_, std::vector{flame(0.0)}, known ? kKnownFire : kUnseenFire, cv::LINE_AA);
    Text(label, foot.x, foot.y + 5.2, label.size() > 1 ? 13.5 : 15, 0.5, known ? kInk : kWhite, 1.6);
  }

  // A mast on a triangle.
  void DrawStation(const cv::Point2d& foot, bool known, const std::string& name) {
    const auto triangle = [&](double grow) {
      return std::vector<cv::Point>{At(foot.x, foot.y - 15 - 1.6 * grow),
                                    At(foot.x + 12 + 1.3 * grow, foot.y + 8 + grow),
                                    At(foot.x - 12 - 1.3 * grow, foot.y + 8 + grow)};
    };
    cv::fillPoly(canvas_, std::vector{triangle(3.4)}, kInk, cv::LINE_AA);
    cv::fillPoly(canvas_, std::vector{triangle(2.2)}, kWhite, cv::LINE_AA);
    cv::fillPoly(canvas_, std::vector{triangle(0.0)}, kStation, cv::LINE_AA);
    if (!known) cv::fillPoly(canvas_, std::vector{triangle(-5.0)}, kWhite, cv::LINE_AA);
    if (name.empty()) return;
    Text(name, foot.x, foot.y + 27, 13.5, 0.5, kWhite, 4.2);
    Text(name, foot.x, foot.y + 27, 13.5, 0.5, kStation, 1.4);
  }

  // Ticks at round distances, about five a side.
  void DrawAxes() {
    const auto step = [](double side_m) {
      for (const double s : {10.0, 20.0, 50.0, 100.0, 200.0, 500.0})
        if (side_m / s <= 7.0) return s;
      return 1000.0;
    };
    const Eigen::Vector3d& size_m = scene_.SizeM();
    for (int i = 0; i * step(size_m.x()) <= size_m.x(); ++i) {
      const double x_m = i * step(size_m.x());
      const cv::Point2d p = OnMap(x_m, 0.0);
      cv::line(canvas_, At(p.x, p.y), At(p.x, p.y + 6), kInk, Px(1.2), cv::LINE_AA);
      Text(fmt::format("{:g}", x_m), p.x, p.y + 21, 12.5, 0.5);
    }
    for (int i = 0; i * step(size_m.y()) <= size_m.y(); ++i) {
      const double y_m = i * step(size_m.y());
      const cv::Point2d p = OnMap(0.0, y_m);
      cv::line(canvas_, At(p.x, p.y), At(p.x - 6, p.y), kInk, Px(1.2), cv::LINE_AA);
      Text(fmt::format("{:g}", y_m), p.x - 10, p.y + 4.5, 12.5, 1.0);
    }
    Text("m east", kLeft + map_width_, kTop + map_height_ + 38, 12.5, 1.0, kFaint);
    Text("m north", kLeft - 10, kTop - 12, 12.5, 0.0, kFaint);
  }

  void DrawScaleBar() {
    const double side_m = scene_.SizeM().x();
    const double bar_m = side_m >= 400 ? 100.0 : side_m >= 80 ? 20.0 : 5.0;
    const double width = bar_m * px_per_m_;
    const double x = kLeft + 18;
    const double y = kTop + map_height_ - 26;
    cv::Mat board = canvas_(cv::Rect(Px(x - 10), Px(y - 22), Px(width + 20), Px(38)));
    board = board * 0.25 + kPaper * 0.75;
    for (int i = 0; i < 4; ++i)
      cv::rectangle(canvas_, At(x + i * width / 4, y), At(x + (i + 1) * width / 4, y + 7),
                    i % 2 ? kWhite : kInk, cv::FILLED);
    cv::rectangle(canvas_, At(x, y), At(x + width, y + 7), kInk, Px(1.0), cv::LINE_AA);
    Text(fmt::format("{:g} m", bar_m), x + width / 2, y - 6, 13, 0.5);
  }

  void DrawLegend() {
    const double x = kLeft + map_width_ + kGap;
    double y = kTop + 16;
    const auto entry = [&](const std::string& text, auto draw) {
      draw(cv::Point2d(x + 14, y));
      Text(text, x + 38, y + 5, 14);
      y += 42;
    };
    entry("fire site, known", [&](cv::Point2d p) { DrawSite(p, true, ""); });
    entry("fire site, unseen", [&](cv::Point2d p) { DrawSite(p, false, ""); });
    entry("base station, known", [&](cv::Point2d p) { DrawStation(p, true, ""); });
    entry("base station, unseen", [&](cv::Point2d p) { DrawStation(p, false, ""); });
    entry("start area", [&](cv::Point2d p) { StartRing(p, 11.0); });
    entry("tree", [&](cv::Point2d p) {
      Disc(p, 7, cv::Scalar(46, 82, 50));
      Disc({p.x - 2, p.y - 2}, 3.5, cv::Scalar(66, 112, 74));
    });
    entry(fmt::format("contours, {:g} m", ContourStepM(highest_m_)), [&](cv::Point2d p) {
      cv::line(canvas_, At(p.x - 13, p.y - 3), At(p.x + 13, p.y - 3), kFaint, Px(1.0), cv::LINE_AA);
      cv::line(canvas_, At(p.x - 13, p.y + 4), At(p.x + 13, p.y + 4), kInk, Px(1.4), cv::LINE_AA);
    });
    DrawElevationBar(x + 2, y + 18);
    DrawSiteList(x, y + 226);
  }

  void DrawElevationBar(double x, double y) {
    constexpr double kWidth = 24, kHeight = 160;
    Text("ground [m]", x - 2, y - 6, 14);
    y += 8;
    for (int i = 0; i < Px(kHeight); ++i) {
      const cv::Vec3f colour = ElevationColour(1.0 - static_cast<double>(i) / Px(kHeight));
      cv::line(canvas_, {Px(x), Px(y) + i}, {Px(x + kWidth), Px(y) + i},
               cv::Scalar(colour[0], colour[1], colour[2]));
    }
    cv::rectangle(canvas_, At(x, y), At(x + kWidth, y + kHeight), kInk, Px(1.0), cv::LINE_AA);
    for (int i = 0; i <= 4; ++i)
      Text(fmt::format("{:.0f}", highest_m_ * (4 - i) / 4.0), x + kWidth + 8, y + kHeight * i / 4.0 + 5,
           12.5);
  }

  void DrawSiteList(double x, double y) {
    const double room = height_ - 20 - y;
    const double line = std::min(19.0, room / static_cast<double>(scene_.Sites().size() + 1));
    if (line < 10.0) return;  // too many to list legibly; the map has their numbers
    Text("fire sites", x, y, 14);
    for (std::size_t i = 0; i < scene_.Sites().size(); ++i) {
      const FireSite& site = scene_.Sites()[i];
      const double baseline = y + line * static_cast<double>(i + 1);
      Text(fmt::format("{}", i + 1), x + 18, baseline, 0.66 * line, 1.0,
           site.known ? cv::Scalar(0, 84, 190) : kUnseenFire, 1.4);
      Text(site.name, x + 26, baseline, 0.66 * line);
    }
  }

  const Scene& scene_;
  const MapOverlay& overlay_;
  double scale_;
  double map_width_ = 0.0, map_height_ = 0.0, height_ = 0.0, px_per_m_ = 0.0;
  double highest_m_ = 1.0;
  cv::Mat canvas_;
};

}  // namespace

void WriteMapPicture(const Scene& scene, const std::string& path, const MapOverlay& overlay, int width_px) {
  ED3R_CHECK(width_px >= 200 && width_px <= 8000, fmt::format("width {} px", width_px));
  WritePicture(MapPicture(scene, overlay, width_px).Draw(), path);
}

}  // namespace ed3r::world
