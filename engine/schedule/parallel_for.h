// The one OpenMP loop of the engine.
#pragma once

#include <cstdint>
#include <functional>

namespace ed3r::schedule {

// Calls body(i) once for each i in 0..count-1 on `threads` OpenMP threads; a thread takes the next i, in
// ascending order, when it is free. `body` must not throw. What was written before the call is visible to
// every body, and what the bodies wrote is visible after it. UserError, and no call of body, when OpenMP
// gives fewer threads than asked (OMP_THREAD_LIMIT); std::system_error when the machine does.
void ParallelFor(int threads, std::int64_t count, const std::function<void(std::int64_t)>& body);

}  // namespace ed3r::schedule
