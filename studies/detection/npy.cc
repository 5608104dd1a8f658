#include "studies/detection/npy.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/core/check.h"

namespace ed3r::detection {
namespace {

constexpr std::uint64_t kMaxSidePx = 20000;
constexpr std::string_view kShape = "'shape':(";

// The four numbers after 'shape': in NPY's header, which is a Python dictionary; none for other than four.
std::optional<std::array<std::uint64_t, 4>> ShapeOf(std::string_view header) {
  const std::size_t found = header.find(kShape);
  if (found == std::string_view::npos) return std::nullopt;
  std::string_view list = header.substr(found + kShape.size());
  list = list.substr(0, list.find(')'));
  std::array<std::uint64_t, 4> shape{};
  for (std::uint64_t& side : shape) {
    while (!list.empty() && (list.front() == ' ' || list.front() == ',')) list.remove_prefix(1);
    const auto [end, error] = std::from_chars(list.data(), list.data() + list.size(), side);
    if (error != std::errc()) return std::nullopt;
    list.remove_prefix(static_cast<std::size_t>(end - list.data()));
  }
  const bool ended = list.find_first_not_of(" ,") == std::string_view::npos;
  return ended ? std::optional(shape) : std::nullopt;
}

// As numpy writes it, without blanks but behind a digit: two numbers stay two.
std::string Plain(std::string_view header) {
  std::string plain;
  for (const char c : header) {
    const bool blank = std::isspace(static_cast<unsigned char>(c)) != 0;
    if (!blank || (!plain.empty() && std::isdigit(static_cast<unsigned char>(plain.back())) != 0))
      plain += blank ? ' ' : c == '"' ? '\'' : c;
  }
  return plain;
}

// Python takes the last of a key's values.
bool HasKeysOnce(std::string_view header) {
  for (const std::string_view key : {"descr", "fortran_order", "shape"}) {
    const std::size_t found = header.find(key);
    if (found == std::string_view::npos || header.find(key, found + 1) != std::string_view::npos)
      return false;
  }
  return true;
}

}  // namespace

NpyFrames::NpyFrames(std::string file, const std::string& name) : bytes_(std::move(file)) {
  const std::string_view bytes = bytes_;
  constexpr std::size_t kStart = 10;  // magic, version, length of the header
  if (bytes.size() < kStart || !bytes.starts_with(std::string_view("\x93NUMPY\x01\x00", 8)))
    throw UserError(fmt::format("{}: is no NPY 1.0 file", name));
  const std::size_t length =
      static_cast<unsigned char>(bytes[8]) + 256u * static_cast<unsigned char>(bytes[9]);
  const std::string_view header = bytes.substr(kStart, length);
  const std::string plain = Plain(header);
  const auto shape = ShapeOf(plain);
  if (!HasKeysOnce(plain) || !shape || (*shape)[3] != 3 ||
      plain.find("'descr':'|u1'") == std::string_view::npos ||
      plain.find("'fortran_order':False") == std::string_view::npos)
    throw UserError(
        fmt::format("{}: a uint8 array of frames x height x width x 3 is wanted, not {}", name, header));
  const auto [frames, height, width, colours] = *shape;
  if (frames < 1 || frames > std::numeric_limits<int>::max() || height < 1 || width < 1 ||
      height > kMaxSidePx || width > kMaxSidePx)
    throw UserError(fmt::format("{}: {} frames of {} x {} pixels; allowed: at least one, sides of 1 .. {}",
                                name, frames, width, height, kMaxSidePx));
  // Divided, not multiplied: the product of a made-up shape need not fit any number.
  const std::uint64_t data = bytes.size() - kStart - header.size(), frame = height * width * 3;
  if (header.size() < length || data % frame != 0 || data / frame != frames)
    throw UserError(
        fmt::format("{}: is damaged: it has {} bytes of frames, its header tells of {} frames of {} bytes",
                    name, data, frames, frame));
  begin_ = kStart + length;
  frames_ = static_cast<int>(frames);
  width_px_ = static_cast<int>(width);
  height_px_ = static_cast<int>(height);
}

std::size_t NpyFrames::FrameBytes() const {
  return 3 * static_cast<std::size_t>(width_px_) * static_cast<std::size_t>(height_px_);
}

perception::FrameStack NpyFrames::Some(int first, int count) const {
  ED3R_CHECK(first >= 0 && count >= 0 && count <= frames_ - first, "frames beyond the last");
  const std::string_view pixels =
      std::string_view(bytes_).substr(begin_ + FrameBytes() * static_cast<std::size_t>(first),
                                      FrameBytes() * static_cast<std::size_t>(count));
  return {.frames = count,
          .width_px = width_px_,
          .height_px = height_px_,
          .rgb = std::vector<std::uint8_t>(pixels.begin(), pixels.end())};
}

}  // namespace ed3r::detection
