// The weights as bytes of the program, so that a run needs no file beside it.
#include "engine/perception/vision/model_file.h"

// ED3R_FULL_WEIGHTS and ED3R_QUANTIZED_WEIGHTS are the paths of the files; the build remakes this object when they change.
asm(R"(
    .section .rodata
    .global ed3r_full_weights_begin
    .global ed3r_full_weights_end
    .global ed3r_quantized_weights_begin
    .global ed3r_quantized_weights_end
    .balign 16
ed3r_full_weights_begin:
    .incbin ")" ED3R_FULL_WEIGHTS R"("
ed3r_full_weights_end:
    .byte 0
    .balign 16
ed3r_quantized_weights_begin:
    .incbin ")" ED3R_QUANTIZED_WEIGHTS R"("
ed3r_quantized_weights_end:
    .byte 0
    .previous
)");

extern "C" const char ed3r_full_weights_begin[];
extern "C" const char ed3r_full_weights_end[];
extern "C" const char ed3r_quantized_weights_begin[];
extern "C" const char ed3r_quantized_weights_end[];

namespace ed3r::perception {

std::string_view BuiltinFullBytes() {
  return {ed3r_full_weights_begin, static_cast<std::size_t>(ed3r_full_weights_end - ed3r_full_weights_begin)};
}

std::string_view BuiltinQuantizedBytes() {
  return {ed3r_quantized_weights_begin,
          static_cast<std::size_t>(ed3r_quantized_weights_end - ed3r_quantized_weights_begin)};
}

}  // namespace ed3r::perception
