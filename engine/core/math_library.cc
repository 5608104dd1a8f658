#include "engine/core/math_library.h"

#include <cmath>
#include <cstdint>

#include "engine/core/sha256.h"

namespace ed3r {
namespace {

constexpr int kArguments = 4096;  // variants differ in the last bit of some per mille of the values

// Evenly over the interval, off the round numbers.
template <class Real>
Real Argument(int i, Real lo, Real hi) {
  return lo + (hi - lo) * (static_cast<Real>(i) + Real(0.618033988749894848)) / Real(kArguments);
}

template <class Real, class Function>
void Add(Sha256& hash, Real lo, Real hi, const Function& function) {
  for (int i = 0; i < kArguments; ++i) {
    const Real value = function(Argument(i, lo, hi));
    hash.Update(&value, sizeof(value));
  }
}

template <class Real>
void AddAll(Sha256& hash) {
  Add<Real>(hash, -50, 50, [](Real x) { return std::sin(x); });
  Add<Real>(hash, -50, 50, [](Real x) { return std::cos(x); });
  Add<Real>(hash, -50, 50, [](Real x) { return std::tan(x); });
  Add<Real>(hash, -1, 1, [](Real x) { return std::asin(x); });
  Add<Real>(hash, -1, 1, [](Real x) { return std::acos(x); });
  Add<Real>(hash, -100, 100, [](Real x) { return std::atan2(x, Real(3)); });
  Add<Real>(hash, -40, 40, [](Real x) { return std::exp(x); });
  Add<Real>(hash, 0, 1000, [](Real x) { return std::log(x); });
  Add<Real>(hash, 0, 1000, [](Real x) { return std::log2(x); });
  Add<Real>(hash, 0, 1000, [](Real x) { return std::log10(x); });
  Add<Real>(hash, -6, 6, [](Real x) { return std::pow(Real(10), x); });
  Add<Real>(hash, 0, 20, [](Real x) { return std::pow(x, Real(2.7)); });
  Add<Real>(hash, 0, 1000, [](Real x) { return std::cbrt(x); });
  Add<Real>(hash, -1000, 1000, [](Real x) { return std::hypot(x, Real(7)); });
}

}  // namespace

std::string MathLibraryIdentity() {
  Sha256 hash;
  AddAll<double>(hash);
  AddAll<float>(hash);
  return hash.Hex().substr(0, 16);
}

}  // namespace ed3r
