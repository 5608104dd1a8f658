// Two ways to fail. User input throws UserError: the program prints its one line and exits with 2.
// A broken invariant throws InternalError through ED3R_CHECK, in every build type: a wrong figure is worse
// than a lost mission, and the scheduler contains the loss (the mission becomes a failed record).
#pragma once

#include <stdexcept>
#include <string>

namespace ed3r {

// Bad input. what() is one line that says where and what is allowed.
class UserError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// A defect of the engine, not of its input.
class InternalError : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

[[noreturn]] void FailCheck(const char* file, int line, const char* condition, const std::string& detail);

}  // namespace ed3r

#define ED3R_CHECK(condition, detail)                                              \
  do {                                                                             \
    if (!(condition)) ::ed3r::FailCheck(__FILE__, __LINE__, #condition, (detail)); \
  } while (false)
