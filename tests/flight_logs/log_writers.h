// Raw logs made byte by byte, as the autopilots write them.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

namespace ed3r::flight_logs {

class Bytes {
 public:
  template <class Number>
  Bytes& Put(Number number) {
    char raw[sizeof(Number)];
    std::memcpy(raw, &number, sizeof(Number));
    bytes_.append(raw, sizeof(Number));
    return *this;
  }
  Bytes& Text(std::string_view text, std::size_t length) {
    bytes_.append(text.substr(0, length));
    bytes_.append(length - std::min(length, text.size()), '\0');
    return *this;
  }
  const std::string& str() const { return bytes_; }

 private:
  std::string bytes_;
};

// ArduPilot DataFlash.
class DataFlashWriter {
 public:
  DataFlashWriter() { Format(128, 89, "FMT", "BBnNZ", "Type,Length,Name,Format,Columns"); }

  void Format(std::uint8_t type, std::uint8_t length, std::string_view name, std::string_view types,
              std::string_view columns) {
    Message(128, Bytes().Put(type).Put(length).Text(name, 4).Text(types, 16).Text(columns, 64));
  }
  void Message(std::uint8_t type, const Bytes& fields) {
    log += "\xA3\x95";
    log += static_cast<char>(type);
    log += fields.str();
  }

  std::string log;
};

// PX4 ULog.
class ULogWriter {
 public:
  ULogWriter() { log = Bytes().Text("ULog\x01\x12\x35\x01", 8).Put(std::uint64_t{0}).str(); }

  void Message(char type, const std::string& content) {
    log += Bytes().Put(static_cast<std::uint16_t>(content.size())).Put(type).str() + content;
  }
  void Topic(std::uint16_t number, std::uint8_t instance, const std::string& name) {
    Message('A', Bytes().Put(instance).Put(number).str() + name);
  }
  void Sample(std::uint16_t number, const Bytes& fields) {
    Message('D', Bytes().Put(number).str() + fields.str());
  }

  std::string log;
};

}  // namespace ed3r::flight_logs
