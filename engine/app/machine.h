// What this program runs on and is made of: for `ed3r doctor` and for the notes that every session stores.
#pragma once

#include <map>
#include <string>

namespace ed3r::app {

// cpu, cores, memory, simd, simd_supported, openmp_threads, compiler, flags, commit, source, and one "lib NAME" each.
// Throws SimdLevelError when ED3R_SIMD is wrong.
std::map<std::string, std::string> DescribeMachine();

// Threads that an OpenMP region really gets when `wanted` are asked for.
int ObtainedThreads(int wanted);

}  // namespace ed3r::app
