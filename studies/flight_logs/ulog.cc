#include "studies/flight_logs/ulog.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <limits>

#include "engine/core/check.h"
#include "engine/core/message.h"
#include "studies/flight_logs/little_endian.h"

namespace ed3r::flight_logs {
namespace {

constexpr std::string_view kMagic = "ULog\x01\x12\x35";
constexpr std::size_t kHeaderLength = 16, kHeadLength = 3;
constexpr std::string_view kKnownTypes = "BFIMPQARDLCSO";

struct BasicType {
  std::string_view name;
  char letter;
  std::size_t size;
};
constexpr BasicType kBasicTypes[] = {{"int8_t", 'b', 1},   {"uint8_t", 'B', 1},  {"int16_t", 'h', 2},
                                     {"uint16_t", 'H', 2}, {"int32_t", 'i', 4},  {"uint32_t", 'I', 4},
                                     {"int64_t", 'q', 8},  {"uint64_t", 'Q', 8}, {"float", 'f', 4},
                                     {"double", 'd', 8},   {"bool", '?', 1},     {"char", 'c', 1}};

const BasicType* FindBasic(std::string_view name) {
  const auto* found = std::find_if(std::begin(kBasicTypes), std::end(kBasicTypes),
                                   [&](const BasicType& type) { return type.name == name; });
  return found == std::end(kBasicTypes) ? nullptr : found;
}

// "type[12] name" to its parts; false where it is nothing of the kind.
bool SplitField(std::string_view text, std::string_view& type, std::size_t& count, std::string_view& name) {
  const std::size_t space = text.find(' ');
  if (space == std::string_view::npos || space == 0 || space + 1 == text.size()) return false;
  type = text.substr(0, space);
  name = text.substr(space + 1);
  count = 1;
  const std::size_t bracket = type.find('[');
  if (bracket == std::string_view::npos) return true;
  const std::string_view number = type.substr(bracket + 1);
  const auto [stop, error] = std::from_chars(number.data(), number.data() + number.size(), count);
  if (error != std::errc() || stop + 1 != number.data() + number.size() || *stop != ']') return false;
  type = type.substr(0, bracket);
  return count <= std::numeric_limits<std::uint16_t>::max();
}

}  // namespace

bool ULog::Is(std::string_view bytes) { return bytes.starts_with(kMagic); }

ULog::ULog(std::string path, std::string_view bytes, const std::set<std::string>& wanted, bool skip_bad)
    : path_(std::move(path)), bytes_(bytes), skipped_(path_, bytes) {
  std::size_t at = kHeaderLength;
  try {
    if (bytes_.size() < kHeaderLength)
      Fail(bytes_.size(), "the file ends inside the header: it is truncated");
    ReadAll(at, wanted);
  } catch (const UserError& error) {
    skipped_.Add(at, bytes_.size(), error.what());
    if (!skip_bad)
      throw UserError(OneLine(fmt::format("{}; --skip-bad reads what stands before", error.what())));
  }
}

// Data that was appended after a crash begins at a place that the flags name; the message before it may be cut off.
void ULog::ReadAll(std::size_t& at, const std::set<std::string>& wanted) {
  std::size_t part = 0;
  while (at < bytes_.size()) {
    while (part < appended_.size() && appended_[part] <= at) ++part;
    const std::size_t end = part < appended_.size() ? appended_[part] : bytes_.size();
    at = ReadMessage(at, end, wanted);
  }
}

std::size_t ULog::ReadMessage(std::size_t at, std::size_t end, const std::set<std::string>& wanted) {
  const bool last = end == bytes_.size();
  if (end - at < kHeadLength) {
    if (!last) return end;
    Fail(at, "the file ends inside a message: it is truncated");
  }
  const auto size = LoadLittleEndian<std::uint16_t>(bytes_, at);
  const char type = bytes_[at + 2];
  if (kKnownTypes.find(type) == std::string_view::npos)
    Fail(at, fmt::format("no message begins here (type {}): the file is damaged", static_cast<int>(type)));
  if (end - at - kHeadLength < size) {
    if (!last) return end;
    Fail(at, fmt::format("the file ends inside a message of type {} ({} of {} bytes): it is truncated", type,
                         end - at - kHeadLength, size));
  }
  const std::string_view content = bytes_.substr(at + kHeadLength, size);
  switch (type) {
    case 'B':
      ReadFlags(at, content);
      break;
    case 'F':
      ReadDescription(at, content);
      break;
    case 'A':
      ReadSubscription(at, content, wanted);
      break;
    case 'D':
      ReadSample(at, content);
      break;
    case 'O':
      ++dropouts_;
      break;
    default:
      break;
  }
  return at + kHeadLength + size;
}

void ULog::ReadFlags(std::size_t at, std::string_view content) {
  constexpr std::size_t kLength = 40, kIncompatible = 8, kOffsets = 16;
  if (content.size() < kLength) Fail(at, "flag bits of fewer than 40 bytes");
  if (std::any_of(content.begin() + kIncompatible, content.begin() + kOffsets,
                  [](char c) { return (c & ~1) != 0; }) ||
      std::any_of(content.begin() + kIncompatible + 1, content.begin() + kOffsets,
                  [](char c) { return c != 0; }))
    Fail(at, "a ULog of a newer kind (an incompatible flag is set)");
  for (std::size_t k = 0; k < 3; ++k) {
    const auto offset = LoadLittleEndian<std::uint64_t>(content, kOffsets + 8 * k);
    if (offset == 0) continue;
    if (offset <= at || offset > bytes_.size())
      Fail(at, fmt::format("appended data at {}, outside the file", offset));
    appended_.push_back(static_cast<std::size_t>(offset));
  }
  std::sort(appended_.begin(), appended_.end());
}

void ULog::ReadDescription(std::size_t at, std::string_view content) {
  const std::size_t colon = content.find(':');
  if (colon == std::string_view::npos || colon == 0) Fail(at, "a description without a name");
  descriptions_.emplace(std::string(content.substr(0, colon)),
                        Description{.text = std::string(content.substr(colon + 1)), .at = at, .fields = {}});
}

const ULog::Description& ULog::Describe(std::size_t at, const std::string& name, int depth) {
  constexpr int kMaxDepth = 8;
  constexpr std::size_t kMaxBytes = 1 << 16;  // a message has no more
  const auto found = descriptions_.find(name);
  if (found == descriptions_.end()) Fail(at, fmt::format("topic '{}' is not described", name));
  Description& description = found->second;
  if (depth + description.levels > kMaxDepth)
    Fail(at, fmt::format("descriptions nest more than {} deep", kMaxDepth));
  if (description.described) return description;
  const std::string& text = description.text;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(';', begin), text.size());
    std::string_view type, field;
    std::size_t count = 0;
    if (!SplitField(std::string_view(text).substr(begin, end - begin), type, count, field))
      Fail(description.at, fmt::format("topic '{}': a field that is not 'type name'", name));
    if (const BasicType* basic = FindBasic(type); basic != nullptr) {
      description.fields.push_back({std::string(field), basic->letter, description.size});
      description.size += basic->size * count;
    } else {
      const Description& inner = Describe(at, std::string(type), depth + 1);
      description.size += inner.size * count;
      description.levels = std::max(description.levels, inner.levels + 1);
    }
    if (description.size > kMaxBytes)
      Fail(description.at, fmt::format("topic '{}' takes more than {} bytes", name, kMaxBytes));
    begin = end + 1;
  }
  description.described = true;
  return description;
}

void ULog::ReadSubscription(std::size_t at, std::string_view content, const std::set<std::string>& wanted) {
  constexpr std::size_t kName = 3;
  if (content.size() <= kName) Fail(at, "a subscription without a topic");
  const auto number = LoadLittleEndian<std::uint16_t>(content, 1);
  Topic topic{.name = std::string(content.substr(kName)),
              .instance = static_cast<unsigned char>(content[0]),
              .fields = nullptr};
  if (numbers_.contains(number)) Fail(at, fmt::format("message number {} is given twice", number));
  if (!wanted.contains(topic.name)) {
    numbers_[number] = std::nullopt;
    return;
  }
  topic.fields = &Describe(at, topic.name, 0).fields;
  numbers_[number] = static_cast<std::uint16_t>(topics_.size());
  topics_.push_back(std::move(topic));
}

void ULog::ReadSample(std::size_t at, std::string_view content) {
  if (content.size() < 2) Fail(at, "a sample without a message number");
  const auto found = numbers_.find(LoadLittleEndian<std::uint16_t>(content, 0));
  if (found == numbers_.end()) Fail(at, "a sample of a topic that was not announced: the file is damaged");
  if (!found->second) return;
  samples_.push_back({static_cast<std::uint32_t>(at + kHeadLength + 2),
                      static_cast<std::uint32_t>(content.size() - 2), *found->second});
}

std::optional<double> ULog::Number(const Sample& sample, std::string_view name) const {
  const std::vector<Field>& fields = *topics_[sample.topic].fields;
  const auto field = std::find_if(fields.begin(), fields.end(),
                                  [&](const Field& candidate) { return candidate.name == name; });
  if (field == fields.end()) return std::nullopt;
  const std::string_view content = bytes_.substr(sample.offset, sample.size);
  return LoadNumber(field->type == '?' ? 'B' : field->type, content, field->offset);
}

std::optional<double> ULog::TimeS(const Sample& sample) const {
  const auto us = Number(sample, "timestamp");
  return us ? std::optional(*us / 1e6) : std::nullopt;
}

void ULog::Fail(std::size_t at, const std::string& what) const {
  throw UserError(fmt::format("{}: byte {}: {}", path_, at, what));
}

}  // namespace ed3r::flight_logs
