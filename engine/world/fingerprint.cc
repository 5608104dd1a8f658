#include "engine/world/fingerprint.h"

#include <fmt/format.h>
#include <openssl/evp.h>

#include <array>
#include <bit>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <span>

#include "engine/core/check.h"

namespace ed3r::world {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are hashed as little-endian bytes");

class Sha256 {
 public:
  Sha256() : context_(EVP_MD_CTX_new(), EVP_MD_CTX_free) {
    ED3R_CHECK(context_ && EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) == 1, "SHA-256");
  }

  template <class T>
  void AddArray(std::span<const T> values) {
    AddCount(values.size());
    AddBytes(values.data(), values.size_bytes());
  }

  void AddText(const std::string& text) { AddArray(std::span<const char>(text)); }

  void AddNumbers(std::initializer_list<double> values) {
    for (const double value : values) AddBytes(&value, sizeof value);
  }

  void AddPoint(const Eigen::Vector3d& point) { AddNumbers({point.x(), point.y(), point.z()}); }

  // Lengths are hashed too, so that no two different scenes give the same bytes.
  void AddCount(std::uint64_t count) { AddBytes(&count, sizeof count); }

  std::string Hex() {
    std::array<unsigned char, EVP_MAX_MD_SIZE> digest;
    unsigned length = 0;
    ED3R_CHECK(EVP_DigestFinal_ex(context_.get(), digest.data(), &length) == 1, "SHA-256");
    std::string text;
    for (unsigned i = 0; i < length; ++i) text += fmt::format("{:02x}", digest[i]);
    return text;
  }

 private:
  void AddBytes(const void* data, std::size_t size) {
    ED3R_CHECK(EVP_DigestUpdate(context_.get(), data, size) == 1, "SHA-256");
  }

  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context_;
};

}  // namespace

std::string SceneFingerprint(const Scene::Parts& parts, const TriangleMesh& mesh) {
  Sha256 sha;
  sha.AddPoint(parts.size_m);
  sha.AddArray(std::span(mesh.vertices_m));
  sha.AddArray(std::span(mesh.triangles));
  sha.AddCount(parts.sites.size());
  for (const FireSite& site : parts.sites) {
    sha.AddText(site.name);
    sha.AddPoint(site.base_m);
    sha.AddCount(site.known);
  }
  sha.AddCount(parts.base_stations.size());
  for (const BaseStation& station : parts.base_stations) {
    sha.AddText(station.name);
    sha.AddPoint(station.antenna_m);
    sha.AddCount(station.known);
  }
  const StartArea& start = parts.start;
  sha.AddNumbers({start.x_m, start.y_m, start.radius_m, start.height_min_m, start.height_max_m});
  const FireShape& fire = parts.fire;
  sha.AddNumbers({fire.flame_height_m, fire.flame_radius_m, fire.total_height_m, fire.smoke_top_radius_m,
                  fire.lean_x_m, fire.lean_y_m});
  return sha.Hex();
}

}  // namespace ed3r::world
