// PX4's ULog files (.ulg): topics whose fields the log itself describes.
//
// A header of 16 bytes, then messages of size, type and content: 'F' describes a topic's fields, 'A' gives a topic and
// instance a number, 'D' is a sample. Sizes, numbers and nested descriptions are checked against what is there before
// they are used. Format: PX4's documentation, "ULog File Format".
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "studies/flight_logs/skipped_bytes.h"

namespace ed3r::flight_logs {

class ULog {
 public:
  struct Field {
    std::string name;
    char type;  // b B h H i I q Q f d ? as in Python's struct; of arrays the element
    std::size_t offset;
  };
  struct Sample {
    std::uint32_t offset, size;  // the topic's fields: behind the message's number
    std::uint16_t topic;         // index into topics()
  };
  struct Topic {
    std::string name;
    int instance = 0;
    const std::vector<Field>* fields = nullptr;  // of its description, which the log keeps
  };

  static bool Is(std::string_view bytes);

  // Keeps the samples of the wanted topics. Throws UserError (path, byte, what was found): a format of another
  // generation, a message that the file's end cuts off or that is none, a sample of a topic that was not announced.
  // With skip_bad reading ends there, and what stands behind is in skipped(). `bytes` must outlive the log.
  ULog(std::string path, std::string_view bytes, const std::set<std::string>& wanted, bool skip_bad);

  const std::vector<Topic>& topics() const { return topics_; }
  const std::vector<Sample>& samples() const { return samples_; }  // in the order of the file
  const SkippedBytes& skipped() const { return skipped_; }
  int dropouts() const { return dropouts_; }

  // Nothing where the topic has no such field or the sample ends before it.
  std::optional<double> Number(const Sample& sample, std::string_view field) const;
  std::optional<double> TimeS(const Sample& sample) const;  // its timestamp: seconds since the board started

 private:
  struct Description {
    std::string text;
    std::size_t at;
    // From here on what Describe makes of the text.
    bool described = false;
    std::vector<Field> fields;  // nested ones are counted but not named
    std::size_t size = 0;       // bytes
    int levels = 0;             // of descriptions within one another below this one
  };

  // `at` is where the message begins that is read.
  void ReadAll(std::size_t& at, const std::set<std::string>& wanted);
  std::size_t ReadMessage(std::size_t at, std::size_t end, const std::set<std::string>& wanted);
  void ReadFlags(std::size_t at, std::string_view content);
  void ReadDescription(std::size_t at, std::string_view content);
  void ReadSubscription(std::size_t at, std::string_view content, const std::set<std::string>& wanted);
  void ReadSample(std::size_t at, std::string_view content);
  // Each description is read once: messages may name it as often as they like, and so may other descriptions.
  const Description& Describe(std::size_t at, const std::string& name, int depth);
  [[noreturn]] void Fail(std::size_t at, const std::string& what) const;

  std::string path_;
  std::string_view bytes_;
  std::map<std::string, Description> descriptions_;
  std::map<std::uint16_t, std::optional<std::uint16_t>>
      numbers_;                        // message number -> topic, nothing if not wanted
  std::vector<std::size_t> appended_;  // places where data was appended after a crash
  std::vector<Topic> topics_;
  std::vector<Sample> samples_;
  SkippedBytes skipped_;
  int dropouts_ = 0;
};

}  // namespace ed3r::flight_logs
