// What a process meets on the file systems of clusters, for LD_PRELOAD:
//   SHIM_FLOCK=missing    flock() is not there (ENOSYS)
//   SHIM_FLOCK=ignored    flock() says yes and locks nothing
//   SHIM_SHM=fails        files called *-shm cannot be mapped
#include <dlfcn.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <string_view>

namespace {

bool Asked(const char* variable, std::string_view value) {
  const char* found = std::getenv(variable);
  return found != nullptr && found == value;
}

bool IsSharedMemory(int descriptor) {
  char link[64], path[4096];
  std::snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
  const ssize_t length = readlink(link, path, sizeof path);
  return length > 0 && std::string_view(path, static_cast<std::size_t>(length)).ends_with("-shm");
}

}  // namespace

extern "C" {

int flock(int descriptor, int operation) noexcept {
  if (Asked("SHIM_FLOCK", "ignored")) return 0;
  if (Asked("SHIM_FLOCK", "missing")) {
    errno = ENOSYS;
    return -1;
  }
  return reinterpret_cast<int (*)(int, int)>(dlsym(RTLD_NEXT, "flock"))(descriptor, operation);
}

void* mmap64(void* at, size_t bytes, int protection, int flags, int descriptor, off64_t offset) noexcept {
  if (Asked("SHIM_SHM", "fails") && descriptor >= 0 && IsSharedMemory(descriptor)) {
    errno = ENODEV;
    return MAP_FAILED;
  }
  using Map = void* (*)(void*, size_t, int, int, int, off64_t);
  return reinterpret_cast<Map>(dlsym(RTLD_NEXT, "mmap64"))(at, bytes, protection, flags, descriptor, offset);
}

void* mmap(void* at, size_t bytes, int protection, int flags, int descriptor, off_t offset) noexcept {
  return mmap64(at, bytes, protection, flags, descriptor, offset);
}

}  // extern "C"
