#include "engine/schedule/parallel_for.h"

#include <fmt/format.h>
#include <omp.h>

#include <atomic>

#include "engine/core/check.h"
#include "engine/core/threads.h"

namespace ed3r::schedule {
namespace {

// The loop's body between two edges that ThreadSanitizer can see. It does not see those of libgomp, which is
// not built with it, and without these every access to what was made before the loop would look like a race.
class Body {
 public:
  explicit Body(const std::function<void(std::int64_t)>& call) : call_(call) { begun_.store(true); }
  void operator()(std::int64_t i) {
    begun_.load();
    call_(i);
    ended_.fetch_add(1);
  }
  void WaitForAll() const { ended_.load(); }

 private:
  const std::function<void(std::int64_t)>& call_;
  std::atomic<bool> begun_{false};
  std::atomic<std::int64_t> ended_{0};
};

// Returns how many threads there were; calls nothing when they are fewer than asked.
[[gnu::no_sanitize("thread")]] int Run(int threads, std::int64_t count, Body& body) {
  int given = 0;
#pragma omp parallel num_threads(threads) default(shared)
  {
#pragma omp single
    given = omp_get_num_threads();
    if (given == threads) {
#pragma omp for schedule(dynamic, 1)
      for (std::int64_t i = 0; i < count; ++i) body(i);
    }
  }
  return given;
}

}  // namespace

void ParallelFor(int threads, std::int64_t count, const std::function<void(std::int64_t)>& call) {
  // A library may have allowed OpenMP to give fewer threads on a loaded machine (OpenCV does); forbid it, and
  // look at what was given.
  omp_set_dynamic(0);
  Body body(call);
  int given = 0;
  WithTeam(threads, [&] { given = Run(threads, count, body); });
  body.WaitForAll();
  if (given != threads)
    throw UserError(
        fmt::format("OpenMP gives {} of {} threads: see OMP_THREAD_LIMIT, or ask for fewer with --threads",
                    given, threads));
}

}  // namespace ed3r::schedule
