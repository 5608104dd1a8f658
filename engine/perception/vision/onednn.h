// oneDNN as the engine needs it: one code path on every CPU, one thread.
#pragma once

#include <dnnl.hpp>
#include <unordered_map>
#include <utility>

namespace ed3r::perception {

// Restricts oneDNN to AVX2 for the whole process, so that single-precision sums do not depend on the CPU, and returns
// its CPU engine. Call it before anything else uses oneDNN. Throws UserError on a CPU without AVX2, InternalError when
// oneDNN was used before. Threads: any.
const dnnl::engine& PinnedEngine();

// Asks the system for the room that the code of a network needs: where oneDNN itself is refused it, it ends the process. Throws
// std::bad_alloc, or UserError where the system forbids code that is made at run time.
void CheckRoomForCode();

// While it lives, oneDNN and OpenMP regions started by this thread run on this thread alone; other threads are not
// touched. Needed while primitives are made, too: their blocking depends on the number of threads.
class OneThread {
 public:
  OneThread();
  ~OneThread();
  OneThread(const OneThread&) = delete;
  OneThread& operator=(const OneThread&) = delete;

 private:
  int before_;
};

// A primitive with its memory. Its scratchpad is its own: oneDNN's default one belongs to the thread that made the
// primitive and must not be used from two threads.
struct PrimitiveStep {
  dnnl::primitive primitive;
  std::unordered_map<int, dnnl::memory> arguments;
};

dnnl::primitive_attr AttributesWithOwnScratchpad();

// Fills in what every step has; `description` is the primitive's descriptor with source, weights and destination.
template <class Primitive, class Description>
PrimitiveStep MakeStep(const Description& description, const dnnl::memory& source,
                       const dnnl::memory& weights, const dnnl::memory& destination) {
  return {Primitive(description),
          {{DNNL_ARG_SRC, source},
           {DNNL_ARG_WEIGHTS, weights},
           {DNNL_ARG_DST, destination},
           {DNNL_ARG_SCRATCHPAD, dnnl::memory(description.scratchpad_desc(), PinnedEngine())}}};
}

// Zeroed memory: oneDNN pads channels to its blocks and may read the padding.
dnnl::memory ZeroedMemory(const dnnl::memory::desc& description);

// A copy of `from` in the layout of `wanted`.
dnnl::memory Copied(const dnnl::memory& from, const dnnl::memory::desc& wanted);

}  // namespace ed3r::perception
