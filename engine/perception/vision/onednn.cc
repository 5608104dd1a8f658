#include "engine/perception/vision/onednn.h"

#include <omp.h>
#include <sys/mman.h>

#include <cerrno>
#include <cstring>
#include <new>

#include "engine/core/check.h"

namespace ed3r::perception {

const dnnl::engine& PinnedEngine() {
  static const dnnl::engine engine = [] {
    dnnl::set_max_cpu_isa(dnnl::cpu_isa::avx2);
    const dnnl::cpu_isa isa = dnnl::get_effective_cpu_isa();
    if (isa == dnnl::cpu_isa::sse41 || isa == dnnl::cpu_isa::avx || isa == dnnl::cpu_isa::all)
      throw UserError("the convolutional detectors need a CPU with AVX2");
    ED3R_CHECK(isa == dnnl::cpu_isa::avx2, "oneDNN chose its instruction set before it could be pinned");
    return dnnl::engine(dnnl::engine::kind::cpu, 0);
  }();
  return engine;
}

void CheckRoomForCode() {
  constexpr std::size_t kBytes = 64 << 20;
  void* const room = mmap(nullptr, kBytes, PROT_READ | PROT_WRITE | PROT_EXEC,
                          MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (room == MAP_FAILED && (errno == EACCES || errno == EPERM))
    throw UserError(
        "this system forbids code that is made at run time, which the convolutional detectors need");
  if (room == MAP_FAILED) throw std::bad_alloc();
  munmap(room, kBytes);
}

OneThread::OneThread() : before_(omp_get_max_threads()) { omp_set_num_threads(1); }
OneThread::~OneThread() { omp_set_num_threads(before_); }

dnnl::primitive_attr AttributesWithOwnScratchpad() {
  dnnl::primitive_attr attributes;
  attributes.set_scratchpad_mode(dnnl::scratchpad_mode::user);
  return attributes;
}

dnnl::memory ZeroedMemory(const dnnl::memory::desc& description) {
  dnnl::memory memory(description, PinnedEngine());
  std::memset(memory.get_data_handle(), 0, description.get_size());
  return memory;
}

dnnl::memory Copied(const dnnl::memory& from, const dnnl::memory::desc& wanted) {
  dnnl::memory to = ZeroedMemory(wanted);
  dnnl::stream stream(PinnedEngine());
  dnnl::memory source = from;
  dnnl::reorder(source, to).execute(stream, source, to);
  stream.wait();
  return to;
}

}  // namespace ed3r::perception
