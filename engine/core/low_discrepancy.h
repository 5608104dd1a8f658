// Points that fill a square more evenly than random ones do, the same at every call.
#pragma once

namespace ed3r {

// Radical inverse of an index from 1 on in [0, 1): one coordinate of the Halton sequence. Use a prime base of
// its own for each coordinate.
inline double RadicalInverse(int index, int base) {
  double value = 0.0, digit = 1.0 / base;
  for (; index > 0; index /= base, digit /= base) value += digit * (index % base);
  return value;
}

}  // namespace ed3r
