// The weights as bytes of the program, so that a run needs no file beside it.
#include "engine/perception/vision/model_file.h"

// ED3R_BUILTIN_WEIGHTS is the path of the file; the build remakes this object when the file changes.
asm(R"(
    .section .rodata
    .global ed3r_builtin_weights_begin
    .global ed3r_builtin_weights_end
    .balign 16
ed3r_builtin_weights_begin:
    .incbin ")" ED3R_BUILTIN_WEIGHTS R"("
ed3r_builtin_weights_end:
    .byte 0
    .previous
)");

extern "C" const char ed3r_builtin_weights_begin[];
extern "C" const char ed3r_builtin_weights_end[];

namespace ed3r::perception {

std::string_view BuiltinDetectorBytes() {
  return {ed3r_builtin_weights_begin,
          static_cast<std::size_t>(ed3r_builtin_weights_end - ed3r_builtin_weights_begin)};
}

}  // namespace ed3r::perception
