#include "engine/world/files/png_pixels.h"

#include <fmt/format.h>
#include <png.h>

#include <csetjmp>
#include <cstring>
#include <vector>

#include "engine/core/check.h"
#include "engine/world/files/exif_orientation.h"

namespace ed3r::world {
namespace {

struct Source {
  std::string_view left;
  std::string error;    // of libpng
  std::string warning;  // of what is see-through, which libpng then leaves out
};

void TakeBytes(png_structp png, png_bytep to, png_size_t size) {
  auto* source = static_cast<Source*>(png_get_io_ptr(png));
  if (size > source->left.size()) png_error(png, "it is cut short");
  std::memcpy(to, source->left.data(), size);
  source->left.remove_prefix(size);
}

[[noreturn]] void OnError(png_structp png, png_const_charp message) {
  static_cast<Source*>(png_get_error_ptr(png))->error = message;
  png_longjmp(png, 1);
}

void OnWarning(png_structp png, png_const_charp message) {
  if (std::string_view(message).starts_with("tRNS: "))
    static_cast<Source*>(png_get_error_ptr(png))->warning = message;
}

// What libpng holds for one file.
class Reader {
 public:
  explicit Reader(Source& source)
      : source_(source),
        png_(png_create_read_struct(PNG_LIBPNG_VER_STRING, &source, OnError, OnWarning)),
        info_(png_ == nullptr ? nullptr : png_create_info_struct(png_)) {
    ED3R_CHECK(info_ != nullptr, "libpng has no memory");
    png_set_read_fn(png_, &source, TakeBytes);
    // What is no colour counts for nothing here. Kept, a thousand notes would leave no room for what follows.
    png_set_keep_unknown_chunks(png_, PNG_HANDLE_CHUNK_NEVER, nullptr, -1);
    // libpng drops an EXIF block that begins as in a JPEG, without a word; as an unknown chunk it comes as it stands, however
    // long it is.
    png_set_chunk_malloc_max(png_, source.left.size());
    const png_byte exif[] = "eXIf";
    png_set_keep_unknown_chunks(png_, PNG_HANDLE_CHUNK_ALWAYS, exif, 1);
    // Others of no pixels may say what is see-through: damaged, they would be left out without a word, too.
    png_set_crc_action(png_, PNG_CRC_ERROR_QUIT, PNG_CRC_ERROR_QUIT);
  }
  ~Reader() { png_destroy_read_struct(&png_, &info_, nullptr); }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  // libpng leaves both by a long jump: nothing here may have a destructor. False: source.error says why.
  bool Header(PngPixels& pixels) {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    png_read_info(png_, info_);
    pixels.sixteen_bits = png_get_bit_depth(png_, info_) == 16;
    pixels.grey = (png_get_color_type(png_, info_) & PNG_COLOR_MASK_COLOR) == 0;
    has_alpha_ = (png_get_color_type(png_, info_) & PNG_COLOR_MASK_ALPHA) != 0;
    if (HasPalette())
      png_set_packing(png_);  // a byte a pixel: libpng gives black for numbers beyond the palette
    else
      AskForBgra();
    png_set_interlace_handling(png_);
    png_read_update_info(png_, info_);
    return true;
  }

  bool Rows(png_bytepp rows) {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    png_read_image(png_, rows);
    png_read_end(png_, info_);
    if (has_alpha_ || source_.warning.empty()) return true;
    source_.error = source_.warning;
    return false;
  }

  // Then the rows are numbers of its colours.
  bool HasPalette() const { return png_get_color_type(png_, info_) == PNG_COLOR_TYPE_PALETTE; }

  // After Rows. False: source.error says why.
  bool Colour(const cv::Mat& numbers, cv::Mat& bgra) const {
    png_colorp palette = nullptr;
    png_bytep alpha = nullptr;
    int colours = 0, with_alpha = 0;
    png_get_PLTE(png_, info_, &palette, &colours);
    png_get_tRNS(png_, info_, &alpha, &with_alpha, nullptr);
    bgra.create(numbers.size(), CV_8UC4);
    for (int y = 0; y < numbers.rows; ++y)
      for (int x = 0; x < numbers.cols; ++x) {
        const int number = numbers.at<unsigned char>(y, x);
        if (number >= colours) {
          source_.error = fmt::format("a pixel of colour {} of 0 .. {}", number, colours - 1);
          return false;
        }
        const png_color& colour = palette[number];
        bgra.at<cv::Vec4b>(y, x) = {colour.blue, colour.green, colour.red,
                                    number < with_alpha ? alpha[number] : png_byte{255}};
      }
    return true;
  }

  // After Rows: the chunk may stand behind the pixels.
  int Orientation() const {
    png_unknown_chunkp exif = nullptr;  // no other kind is kept
    if (png_get_unknown_chunks(png_, info_, &exif) == 0) return 1;
    return ExifOrientation({reinterpret_cast<const char*>(exif->data), exif->size});
  }

  cv::Size Size() const {
    return {static_cast<int>(png_get_image_width(png_, info_)),
            static_cast<int>(png_get_image_height(png_, info_))};
  }
  std::size_t RowBytes() const { return png_get_rowbytes(png_, info_); }

 private:
  void AskForBgra() {
    png_set_expand(png_);
    png_set_strip_16(png_);
    png_set_gray_to_rgb(png_);
    png_set_add_alpha(png_, 255, PNG_FILLER_AFTER);
    png_set_bgr(png_);
  }

  Source& source_;
  png_structp png_;
  png_infop info_;
  bool has_alpha_ = false;
};

}  // namespace

PngPixels DecodePng(std::string_view bytes, const std::string& name) {
  Source source{bytes, {}, {}};
  Reader reader(source);
  PngPixels pixels;
  const auto refuse = [&] {
    throw UserError(fmt::format("{}: is damaged or cut short: {}", name, source.error));
  };
  if (!reader.Header(pixels)) refuse();
  cv::Mat read(reader.Size(), reader.HasPalette() ? CV_8UC1 : CV_8UC4);
  ED3R_CHECK(reader.RowBytes() == read.step, "four bytes a pixel, or one");
  std::vector<png_bytep> rows;
  rows.reserve(static_cast<std::size_t>(read.rows));
  for (int y = 0; y < read.rows; ++y) rows.push_back(read.ptr(y));
  if (!reader.Rows(rows.data())) refuse();
  if (!reader.HasPalette())
    pixels.bgra = read;
  else if (!reader.Colour(read, pixels.bgra))
    refuse();
  pixels.orientation = reader.Orientation();
  return pixels;
}

}  // namespace ed3r::world
