// Which mathematical functions the C library gives here. glibc rounds sin, cos, exp, log, pow and their like otherwise on CPUs
// with fused multiply-add, and may from version to version, so results of one kind belong together and of two do not.
//
// Threads: any.
#pragma once

#include <string>

namespace ed3r {

// 16 hexadecimal digits: equal where all functions that the engine and Bullet call give equal bits, on some thousands of
// arguments over their range.
std::string MathLibraryIdentity();

}  // namespace ed3r
