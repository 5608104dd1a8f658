// The world that stands for the paper's: the default world of the program.
//
// Threads: any.
#pragma once

#include <span>
#include <string_view>

namespace ed3r::paper {

// One file of it, as it lay beside the program's sources when that was built.
struct PaperWorldFile {
  std::string_view name;    // in the world's folder: "paper.yaml"
  std::string_view sha256;  // of its content, hexadecimal
};

// The world file first, then all that it reads.
std::span<const PaperWorldFile> PaperWorldFiles();

}  // namespace ed3r::paper
