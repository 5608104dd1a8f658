// A machine that has no more threads, for LD_PRELOAD: SHIM_THREADS=n lets n of them live at once beside the first.
#include <dlfcn.h>
#include <pthread.h>

#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <memory>

namespace {

std::atomic<int> live{0};

struct Work {
  void* (*call)(void*);
  void* argument;
};

void* Call(void* work) {
  const std::unique_ptr<Work> mine(static_cast<Work*>(work));
  void* const result = mine->call(mine->argument);
  --live;
  return result;
}

}  // namespace

extern "C" int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*call)(void*),
                              void* argument) noexcept {
  const char* most = std::getenv("SHIM_THREADS");
  if (most != nullptr && ++live > std::atoi(most)) {
    --live;
    return EAGAIN;
  }
  using Create = int (*)(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*);
  const auto create = reinterpret_cast<Create>(dlsym(RTLD_NEXT, "pthread_create"));
  return create(thread, attributes, Call, new Work{call, argument});
}
