#include "engine/world/files/jpeg_check.h"

#include <fmt/format.h>

#include <csetjmp>
#include <cstddef>
#include <cstdio>
// Wants the two above.
#include <jpeglib.h>

#include "engine/core/check.h"

namespace ed3r::world {
namespace {

struct Complaints {
  jpeg_error_mgr base;  // first: libjpeg knows of this part alone
  std::jmp_buf out;
  char first[JMSG_LENGTH_MAX];
};

[[noreturn]] void Leave(j_common_ptr jpeg) {
  auto* complaints = reinterpret_cast<Complaints*>(jpeg->err);
  jpeg->err->format_message(jpeg, complaints->first);
  std::longjmp(complaints->out, 1);
}

void OnMessage(j_common_ptr jpeg, int level) {
  if (level < 0) Leave(jpeg);  // a warning; the others are traces
}

// 0: complaints.first says why. Nothing here may have a destructor: libjpeg's errors leave by a long jump.
int Channels(std::string_view bytes, Complaints& complaints) {
  jpeg_decompress_struct jpeg;
  jpeg.err = jpeg_std_error(&complaints.base);
  complaints.base.error_exit = Leave;
  complaints.base.emit_message = OnMessage;
  jpeg_create_decompress(&jpeg);
  if (setjmp(complaints.out) != 0) {
    jpeg_destroy_decompress(&jpeg);
    return 0;
  }
  jpeg_mem_src(&jpeg, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
  jpeg_read_header(&jpeg, TRUE);
  jpeg_start_decompress(&jpeg);
  const JDIMENSION row_bytes = jpeg.output_width * static_cast<JDIMENSION>(jpeg.output_components);
  JSAMPARRAY row = jpeg.mem->alloc_sarray(reinterpret_cast<j_common_ptr>(&jpeg), JPOOL_IMAGE, row_bytes, 1);
  while (jpeg.output_scanline < jpeg.output_height) jpeg_read_scanlines(&jpeg, row, 1);
  const int channels = jpeg.num_components;
  jpeg_finish_decompress(&jpeg);
  jpeg_destroy_decompress(&jpeg);
  return channels;
}

}  // namespace

int CheckJpeg(std::string_view bytes, const std::string& name) {
  Complaints complaints;
  const int channels = Channels(bytes, complaints);
  if (channels == 0) throw UserError(fmt::format("{}: is damaged or cut short: {}", name, complaints.first));
  return channels;
}

}  // namespace ed3r::world
