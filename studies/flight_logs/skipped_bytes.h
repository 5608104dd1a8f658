// What of a raw log was passed over because it could not be read (LogReading::skip_bad).
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace ed3r::flight_logs {

class SkippedBytes {
 public:
  // `path` stands in messages. Of the file's bytes those count that were written: flash at its end that never was does not.
  SkippedBytes(const std::string& path, std::string_view file);

  // [from, to) is passed over, as `problem` tells. Throws UserError that begins with it once more than kMaxBadShare of the
  // file are: a log that lacks more is another flight.
  void Add(std::size_t from, std::size_t to, const std::string& problem);

  int places() const { return places_; }
  // One line for the report; places() is above 0.
  std::string Note() const;

 private:
  std::string path_;
  std::size_t written_ = 0, skipped_ = 0, first_ = 0;
  int places_ = 0;
};

}  // namespace ed3r::flight_logs
