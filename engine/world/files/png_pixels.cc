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
  std::string error;  // of libpng
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

void OnWarning(png_structp, png_const_charp) {}

// What libpng holds for one file.
class Reader {
 public:
  explicit Reader(Source& source)
      : png_(png_create_read_struct(PNG_LIBPNG_VER_STRING, &source, OnError, OnWarning)),
        info_(png_ == nullptr ? nullptr : png_create_info_struct(png_)) {
    ED3R_CHECK(info_ != nullptr, "libpng has no memory");
    png_set_read_fn(png_, &source, TakeBytes);
    // libpng drops an EXIF block that begins as in a JPEG, without a word; as an unknown chunk it comes as it stands.
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
    png_set_expand(png_);
    png_set_strip_16(png_);
    png_set_gray_to_rgb(png_);
    png_set_add_alpha(png_, 255, PNG_FILLER_AFTER);
    png_set_bgr(png_);
    png_set_interlace_handling(png_);
    png_read_update_info(png_, info_);
    return true;
  }

  bool Rows(png_bytepp rows) {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    png_read_image(png_, rows);
    png_read_end(png_, info_);
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
  png_structp png_;
  png_infop info_;
};

}  // namespace

PngPixels DecodePng(std::string_view bytes, const std::string& name) {
  Source source{bytes, {}};
  Reader reader(source);
  PngPixels pixels;
  const auto refuse = [&] {
    throw UserError(fmt::format("{}: is damaged or cut short: {}", name, source.error));
  };
  if (!reader.Header(pixels)) refuse();
  pixels.bgra.create(reader.Size(), CV_8UC4);
  ED3R_CHECK(reader.RowBytes() == pixels.bgra.step, "four bytes a pixel");
  std::vector<png_bytep> rows;
  rows.reserve(static_cast<std::size_t>(pixels.bgra.rows));
  for (int y = 0; y < pixels.bgra.rows; ++y) rows.push_back(pixels.bgra.ptr(y));
  if (!reader.Rows(rows.data())) refuse();
  pixels.orientation = reader.Orientation();
  return pixels;
}

}  // namespace ed3r::world
