// GDAL for the time of one object: it prints nothing, opens files of the disk alone, never asks a network, knows the two
// formats that are read here, and reads them alike: from the first object on, its environment variables and configuration
// files count for nothing in the whole process. What it complains of is kept: it goes on after most of it, without a
// scale, a mask or a coordinate system.
// Threads: an object belongs to the thread that made it.
#pragma once

#include <string>

namespace ed3r::world {

class QuietGdal {
 public:
  QuietGdal();
  ~QuietGdal();
  QuietGdal(const QuietGdal&) = delete;
  QuietGdal& operator=(const QuietGdal&) = delete;

  // The first warning or error since this object was made or Forgive was called that may change a number, in one line;
  // "" where there was none.
  const std::string& Complaint() const { return complaint_; }
  void Forgive() { complaint_.clear(); }

  // In one line.
  static std::string LastError();

 private:
  void Hear(const std::string& message);

  std::string complaint_;
  char** options_before_;
};

}  // namespace ed3r::world
