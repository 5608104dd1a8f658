#include "studies/flight_logs/dataflash.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <iterator>

#include "engine/core/check.h"
#include "engine/core/message.h"
#include "studies/flight_logs/little_endian.h"

namespace ed3r::flight_logs {
namespace {

constexpr std::string_view kHead = "\xA3\x95";
constexpr std::uint8_t kFormatType = 128;
constexpr std::size_t kFormatLength = 89, kHeadLength = 3;

// Bytes of a field, 0 for a letter that there is not.
std::size_t SizeOf(char type) {
  switch (type) {
    case 'b':
    case 'B':
    case 'M':
      return 1;
    case 'h':
    case 'H':
    case 'c':
    case 'C':
    case 'g':
      return 2;
    case 'i':
    case 'I':
    case 'e':
    case 'E':
    case 'L':
    case 'f':
    case 'n':
      return 4;
    case 'q':
    case 'Q':
    case 'd':
      return 8;
    case 'N':
      return 16;
    case 'Z':
    case 'a':
      return 64;
    default:
      return 0;
  }
}

// The text of a field of fixed length, up to its first zero.
std::string TextAt(std::string_view bytes, std::size_t at, std::size_t length) {
  const std::string_view field = bytes.substr(at, length);
  return std::string(field.substr(0, field.find('\0')));
}

bool IsPlain(const std::string& text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return c > ' ' && c < 127; });
}

// A float as the shortest decimal that means it, which is what any export of the log prints: 0.4, not 0.40000000596.
double ShortestDecimal(float number) {
  char text[32];
  const auto [end, problem] = std::to_chars(std::begin(text), std::end(text), number);
  double value = number;
  if (problem == std::errc()) std::from_chars(text, end, value);
  return value;
}

// Flash that was never written, at the end of a log.
bool IsPadding(std::string_view bytes) {
  return bytes.find_first_not_of('\xFF') == std::string_view::npos ||
         bytes.find_first_not_of('\0') == std::string_view::npos;
}

}  // namespace

bool DataFlashLog::Is(std::string_view bytes) { return bytes.starts_with("\xA3\x95\x80"); }

DataFlashLog::DataFlashLog(std::string path, std::string_view bytes, const std::set<std::string>& wanted,
                           bool skip_bad)
    : path_(std::move(path)), bytes_(bytes), skipped_(path_, bytes) {
  formats_[kFormatType] = {.name = "FMT", .length = kFormatLength, .fields = {}};
  std::size_t at = 0;
  while (at < bytes_.size()) {
    if (IsPadding(bytes_.substr(at, 64)) && IsPadding(bytes_.substr(at))) return;
    try {
      at = ReadMessage(at, wanted);
    } catch (const UserError& error) {
      const std::size_t next = NextWhole(at);
      skipped_.Add(at, next, error.what());
      if (!skip_bad)
        throw UserError(OneLine(fmt::format("{}; --skip-bad reads what is whole", error.what())));
      at = next;
    }
  }
}

// Whether what looks like a message is of a kind that is described, and ends within the file.
bool DataFlashLog::IsWhole(std::size_t at) const {
  if (bytes_.size() - at < kHeadLength) return false;
  const Format& format = formats_[LoadLittleEndian<std::uint8_t>(bytes_, at + kHead.size())];
  return format.length != 0 && bytes_.size() - at >= format.length;
}

std::size_t DataFlashLog::NextWhole(std::size_t at) const {
  do {
    at = std::min(bytes_.find(kHead, at + 1), bytes_.size());
  } while (at < bytes_.size() && !IsWhole(at));
  return at;
}

std::size_t DataFlashLog::ReadMessage(std::size_t at, const std::set<std::string>& wanted) {
  if (bytes_.size() - at < kHeadLength) Fail(at, "the file ends inside a message: it is truncated");
  if (bytes_.substr(at, kHead.size()) != kHead)
    Fail(at, "no message begins here (A3 95 was expected): the file is damaged");
  const auto type = LoadLittleEndian<std::uint8_t>(bytes_, at + kHead.size());
  const Format& format = formats_[type];
  if (format.length == 0) Fail(at, fmt::format("a message of type {} that no FMT message describes", type));
  if (bytes_.size() - at < format.length)
    Fail(at, fmt::format("the file ends inside a {} message ({} of {} bytes): it is truncated", format.name,
                         bytes_.size() - at, format.length));
  const std::size_t next = at + format.length;
  if (type == kFormatType)
    ReadFormat(at);
  else if (wanted.contains(format.name))
    messages_.push_back({static_cast<std::uint32_t>(at), type});
  return next;
}

void DataFlashLog::ReadFormat(std::size_t at) {
  constexpr std::size_t kName = 5, kNameLength = 4, kTypes = 9, kTypesLength = 16, kColumns = 25,
                        kColumnsLength = 64;
  const auto type = LoadLittleEndian<std::uint8_t>(bytes_, at + kHeadLength);
  const auto length = LoadLittleEndian<std::uint8_t>(bytes_, at + kHeadLength + 1);
  Format format{.name = TextAt(bytes_, at + kName, kNameLength), .length = length, .fields = {}};
  const std::string types = TextAt(bytes_, at + kTypes, kTypesLength);
  const std::string columns = TextAt(bytes_, at + kColumns, kColumnsLength);
  if (!IsPlain(format.name) || !IsPlain(types) || !IsPlain(columns))
    Fail(at, "an FMT message whose names are no text: the file is damaged");
  if (type == kFormatType) return;
  std::size_t offset = kHeadLength, begin = 0;
  for (const char letter : types) {
    if (SizeOf(letter) == 0) Fail(at, fmt::format("FMT of {}: unknown field type '{}'", format.name, letter));
    const std::size_t end = std::min(columns.find(',', begin), columns.size());
    format.fields.push_back(
        {begin < columns.size() ? columns.substr(begin, end - begin) : "", letter, offset});
    begin = end + 1;
    offset += SizeOf(letter);
  }
  if (length < kHeadLength || (offset != length && !types.empty()))
    Fail(at, fmt::format("FMT of {}: its fields take {} bytes, but its length is {}", format.name, offset,
                         length));
  const Format& known = formats_[type];
  if (known.length != 0 && (known.name != format.name || known.length != format.length ||
                            known.fields.size() != format.fields.size()))
    Fail(at, fmt::format("FMT of {}: type {} is {} already", format.name, type, known.name));
  if (known.length == 0) formats_[type] = std::move(format);
}

std::optional<double> DataFlashLog::Number(const Message& message, std::string_view name, char* type) const {
  const Format& format = formats_[message.type];
  const auto field = std::find_if(format.fields.begin(), format.fields.end(),
                                  [&](const Field& candidate) { return candidate.name == name; });
  if (field == format.fields.end()) return std::nullopt;
  if (type != nullptr) *type = field->type;
  const std::size_t at = message.offset + field->offset;
  // Letters of its own beside those of LoadNumber: hundredths, degrees of latitude and longitude, flight modes.
  const auto scaled = [&](char code, double unit) -> std::optional<double> {
    const std::optional<double> number = LoadNumber(code, bytes_, at);
    return number ? std::optional(*number / unit) : std::nullopt;
  };
  switch (field->type) {
    case 'f':
      return ShortestDecimal(LoadLittleEndian<float>(bytes_, at));
    case 'M':
      return LoadNumber('B', bytes_, at);
    case 'c':
      return scaled('h', 100.0);
    case 'C':
      return scaled('H', 100.0);
    case 'e':
      return scaled('i', 100.0);
    case 'E':
      return scaled('I', 100.0);
    case 'L':
      return scaled('i', 1e7);
    default:
      return LoadNumber(field->type, bytes_, at);
  }
}

std::optional<double> DataFlashLog::TimeS(const Message& message) const {
  if (const auto us = Number(message, "TimeUS")) return *us / 1e6;
  if (FormatOf(message).name == "GPS") {
    if (const auto ms = Number(message, "T")) return *ms / 1e3;
    return std::nullopt;
  }
  if (const auto ms = Number(message, "TimeMS")) return *ms / 1e3;
  return std::nullopt;
}

void DataFlashLog::Fail(std::size_t at, const std::string& what) const {
  throw UserError(fmt::format("{}: byte {}: {}", path_, at, what));
}

}  // namespace ed3r::flight_logs
