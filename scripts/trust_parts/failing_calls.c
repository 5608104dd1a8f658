// Preloaded into the program: the n-th call that touches a file below a folder fails with an error of the system.
//   TRUST_UNDER   the folder
//   TRUST_FAIL_AT which call fails, counted from 1; 0 none
//   TRUST_ERRNO   with what, e.g. 28 (ENOSPC)
//   TRUST_STICKY  1: every later call fails as well
//   TRUST_COUNT   a file that gets the number of calls at the end
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <unistd.h>

static atomic_long calls;
static const char* under;
static long fail_at;
static int error_number, sticky;

static void end(void) {
  const char* file = getenv("TRUST_COUNT");
  FILE* out = file == NULL ? NULL : fopen(file, "w");
  if (out == NULL) return;
  fprintf(out, "%ld\n", atomic_load(&calls));
  fclose(out);
}

__attribute__((constructor)) static void begin(void) {
  under = getenv("TRUST_UNDER");
  fail_at = atol(getenv("TRUST_FAIL_AT") ? getenv("TRUST_FAIL_AT") : "0");
  error_number = atoi(getenv("TRUST_ERRNO") ? getenv("TRUST_ERRNO") : "5");
  sticky = getenv("TRUST_STICKY") != NULL;
  atexit(end);
}

static int fails(void) {
  const long n = atomic_fetch_add(&calls, 1) + 1;
  if (fail_at == 0 || (sticky ? n < fail_at : n != fail_at)) return 0;
  errno = error_number;
  return 1;
}

static int path_fails(const char* path) {
  return under != NULL && path != NULL && strncmp(path, under, strlen(under)) == 0 && fails();
}

static int fd_fails(int fd) {
  char link[64], path[4096];
  if (under == NULL) return 0;
  snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
  const ssize_t size = readlink(link, path, sizeof path - 1);
  if (size < 0) return 0;
  path[size] = '\0';
  return path_fails(path);
}

#define REAL(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

#define OPEN(name)                                                  \
  int name(const char* path, int flags, ...) {                      \
    va_list list;                                                   \
    va_start(list, flags);                                          \
    const mode_t mode = flags & (O_CREAT | O_TMPFILE) ? va_arg(list, mode_t) : 0; \
    va_end(list);                                                   \
    return path_fails(path) ? -1 : REAL(name)(path, flags, mode);   \
  }
OPEN(open)
OPEN(open64)

#define WRAP(type, failed, name, parameters, arguments, check) \
  type name parameters { return check ? failed : REAL(name) arguments; }

WRAP(ssize_t, -1, read, (int fd, void* b, size_t n), (fd, b, n), fd_fails(fd))
WRAP(ssize_t, -1, pread, (int fd, void* b, size_t n, off_t o), (fd, b, n, o), fd_fails(fd))
WRAP(ssize_t, -1, pread64, (int fd, void* b, size_t n, off64_t o), (fd, b, n, o), fd_fails(fd))
WRAP(ssize_t, -1, write, (int fd, const void* b, size_t n), (fd, b, n), fd_fails(fd))
WRAP(ssize_t, -1, pwrite, (int fd, const void* b, size_t n, off_t o), (fd, b, n, o), fd_fails(fd))
WRAP(ssize_t, -1, pwrite64, (int fd, const void* b, size_t n, off64_t o), (fd, b, n, o), fd_fails(fd))
WRAP(int, -1, fsync, (int fd), (fd), fd_fails(fd))
WRAP(int, -1, fdatasync, (int fd), (fd), fd_fails(fd))
WRAP(int, -1, ftruncate, (int fd, off_t n), (fd, n), fd_fails(fd))
WRAP(int, -1, ftruncate64, (int fd, off64_t n), (fd, n), fd_fails(fd))
WRAP(int, -1, rename, (const char* a, const char* b), (a, b), path_fails(b))
WRAP(int, -1, unlink, (const char* a), (a), path_fails(a))
WRAP(int, -1, mkdir, (const char* a, mode_t m), (a, m), path_fails(a))
WRAP(int, -1, flock, (int fd, int o), (fd, o), fd_fails(fd))
WRAP(void*, MAP_FAILED, mmap64, (void* a, size_t n, int p, int f, int fd, off64_t o), (a, n, p, f, fd, o),
     fd >= 0 && fd_fails(fd))
