// GDAL for the time of one object: it prints nothing, opens files of the disk alone, never asks a network, and knows the
// two formats that are read here. Threads: an object belongs to the thread that made it.
#pragma once

#include <string>

namespace ed3r::world {

class QuietGdal {
 public:
  QuietGdal();
  ~QuietGdal();
  QuietGdal(const QuietGdal&) = delete;
  QuietGdal& operator=(const QuietGdal&) = delete;

  // In one line.
  static std::string LastError();
};

}  // namespace ed3r::world
