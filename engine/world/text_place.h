// Where in a text file something stands, for error messages. Lines and columns count from 1.
#pragma once

#include <string>

namespace ed3r {

struct TextPlace {
  std::string file;
  int line = 1;
  int column = 1;
};

// Throws UserError "file:line:column: problem".
[[noreturn]] void FailAt(const TextPlace& place, const std::string& problem);

// "file: cannot be read (why)" as UserError, or the file's whole text.
std::string ReadTextFile(const std::string& file);

}  // namespace ed3r
