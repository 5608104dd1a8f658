// ArduPilot's DataFlash logs (.bin): messages that the log itself describes by FMT messages.
//
// Every message begins with the bytes A3 95 and its type; type 128 (FMT) gives type, length, name, format string and
// column names of another. Sizes are checked against the format string and the file's end before they are used.
// Format: ArduPilot's documentation, "Downloading and Analyzing Data Logs", and libraries/AP_Logger/LogStructure.h.
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "studies/flight_logs/skipped_bytes.h"

namespace ed3r::flight_logs {

class DataFlashLog {
 public:
  struct Field {
    std::string name;
    char type;           // of the format string
    std::size_t offset;  // from the message's first byte
  };
  struct Format {
    std::string name;
    std::size_t length = 0;  // header included; 0: not described
    std::vector<Field> fields;
  };
  struct Message {
    std::uint32_t offset;
    std::uint8_t type;
  };

  static bool Is(std::string_view bytes);

  // Keeps the messages of the wanted names. Throws UserError (path, byte, what was found): an unknown type, a
  // description that does not add up, a message that the file's end cuts off. With skip_bad such bytes are passed over
  // up to the next message that is whole, and are in skipped(). `bytes` must outlive the log.
  DataFlashLog(std::string path, std::string_view bytes, const std::set<std::string>& wanted, bool skip_bad);

  const std::vector<Message>& messages() const { return messages_; }  // in the order of the file
  const Format& FormatOf(const Message& message) const { return formats_[message.type]; }
  const SkippedBytes& skipped() const { return skipped_; }

  // A number as the format string scales it (c, C, e, E: hundredths, L: 1e-7); nothing where the message has no such
  // number. `type`, where given, receives the format's letter.
  std::optional<double> Number(const Message& message, std::string_view field, char* type = nullptr) const;

  // Seconds since the board started: TimeUS, or TimeMS, or for GPS messages of before 2015 T (their TimeMS is GPS time).
  std::optional<double> TimeS(const Message& message) const;

 private:
  bool IsWhole(std::size_t at) const;
  std::size_t NextWhole(std::size_t at) const;  // behind `at`
  std::size_t ReadMessage(std::size_t at, const std::set<std::string>& wanted);
  void ReadFormat(std::size_t at);
  [[noreturn]] void Fail(std::size_t at, const std::string& what) const;

  std::string path_;
  std::string_view bytes_;
  Format formats_[256];
  std::vector<Message> messages_;
  SkippedBytes skipped_;
};

}  // namespace ed3r::flight_logs
