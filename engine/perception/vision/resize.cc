#include "engine/perception/vision/resize.h"

#include <algorithm>

#include "engine/core/check.h"

namespace ed3r::perception {
namespace {

constexpr int kMaxSide_px = 20000;

// Where output pixel `to` of `size` begins and how much of each input pixel it covers, in units of 1 / size.
struct Cover {
  int first;
  std::vector<std::uint64_t> shares;  // sum: input size
};

std::vector<Cover> Covers(int from_size, int to_size) {
  std::vector<Cover> covers;
  for (std::int64_t to = 0; to < to_size; ++to) {
    const std::int64_t begin = to * from_size, end = begin + from_size;
    Cover cover{static_cast<int>(begin / to_size), {}};
    for (std::int64_t i = cover.first; i * to_size < end; ++i) {
      const std::int64_t low = std::max(begin, i * to_size), high = std::min(end, (i + 1) * to_size);
      cover.shares.push_back(static_cast<std::uint64_t>(high - low));
    }
    covers.push_back(std::move(cover));
  }
  return covers;
}

// Half the width and height, with the rounding of the general case.
FrameStack Halved(const FrameStack& frames) {
  FrameStack result{
      .frames = frames.frames, .width_px = frames.width_px / 2, .height_px = frames.height_px / 2, .rgb = {}};
  const auto row_bytes = 3 * static_cast<std::size_t>(frames.width_px);
  const auto rows = static_cast<std::size_t>(frames.frames) * static_cast<std::size_t>(result.height_px);
  result.rgb.resize(rows * row_bytes / 2);
  std::uint8_t* out = result.rgb.data();
  for (std::size_t row = 0; row < rows; ++row) {
    const std::uint8_t* upper = frames.rgb.data() + 2 * row * row_bytes;
    const std::uint8_t* lower = upper + row_bytes;
    for (std::size_t x = 0; x < row_bytes; x += 6)
      for (std::size_t c = x; c < x + 3; ++c)
        *out++ = static_cast<std::uint8_t>((upper[c] + upper[c + 3] + lower[c] + lower[c + 3] + 2) / 4);
  }
  return result;
}

}  // namespace

FrameStack Resized(const FrameStack& frames, int width_px, int height_px) {
  for (const int side : {frames.width_px, frames.height_px, width_px, height_px})
    ED3R_CHECK(side >= 1 && side <= kMaxSide_px, "a picture side out of range");
  if (frames.width_px == width_px && frames.height_px == height_px) return frames;
  if (frames.width_px == 2 * width_px && frames.height_px == 2 * height_px) return Halved(frames);
  const std::vector<Cover> columns = Covers(frames.width_px, width_px),
                           rows = Covers(frames.height_px, height_px);
  const std::uint64_t area =
      static_cast<std::uint64_t>(frames.width_px) * static_cast<std::uint64_t>(frames.height_px);
  FrameStack result{.frames = frames.frames, .width_px = width_px, .height_px = height_px, .rgb = {}};
  const auto row_bytes = 3 * static_cast<std::size_t>(frames.width_px);
  const std::size_t frame_bytes = row_bytes * static_cast<std::size_t>(frames.height_px);
  for (std::size_t f = 0; f < static_cast<std::size_t>(frames.frames); ++f)
    for (const Cover& row : rows)
      for (const Cover& column : columns)
        for (std::size_t c = 0; c < 3; ++c) {
          std::uint64_t sum = 0;
          for (std::size_t y = 0; y < row.shares.size(); ++y) {
            const std::uint8_t* pixel = frames.rgb.data() + f * frame_bytes +
                                        (static_cast<std::size_t>(row.first) + y) * row_bytes +
                                        3 * static_cast<std::size_t>(column.first) + c;
            for (std::size_t x = 0; x < column.shares.size(); ++x)
              sum += row.shares[y] * column.shares[x] * pixel[3 * x];
          }
          result.rgb.push_back(static_cast<std::uint8_t>((2 * sum + area) / (2 * area)));
        }
  return result;
}

}  // namespace ed3r::perception
