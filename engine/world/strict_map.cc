#include "engine/world/strict_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include "engine/core/check.h"
#include "engine/core/suggest.h"

namespace ed3r {
namespace {

std::string RangeText(const AllowedRange& range) {
  return fmt::format("{:g} .. {:g}{}{}", range.min, range.max, range.unit.empty() ? "" : " ", range.unit);
}

// A value as the file shows it, short enough for one line.
std::string ValueText(const YAML::Node& node) {
  if (node.IsSequence()) return "[...]";
  if (node.IsMap()) return "{...}";
  std::string text = node.IsScalar() ? node.Scalar() : "";
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
  if (text.size() > 60) text = text.substr(0, 57) + "...";
  return text;
}

template <class T>
std::optional<T> Parse(const YAML::Node& node) {
  if (!node.IsScalar()) return std::nullopt;
  std::string_view text = node.Scalar();
  if (text.starts_with('+')) text.remove_prefix(1);
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace

StrictMap StrictMap::FromFile(const std::string& file) {
  const std::string text = ReadTextFile(file);
  try {
    const std::vector<YAML::Node> documents = YAML::LoadAll(text);
    if (documents.size() > 1)
      FailAt({file, documents[1].Mark().line + 1, documents[1].Mark().column + 1},
             "a second YAML document; allowed: one");
    return StrictMap(documents.empty() ? YAML::Node() : documents[0], file, "");
  } catch (const YAML::Exception& error) {
    if (error.mark.is_null()) FailAt({file}, error.msg);
    FailAt({file, error.mark.line + 1, error.mark.column + 1}, error.msg);
  }
}

StrictMap::StrictMap(const YAML::Node& node, std::string file, std::string path)
    : node_(node), file_(std::move(file)), path_(std::move(path)) {
  const std::string name = path_.empty() ? "" : path_.substr(0, path_.size() - 1) + ": ";
  if (!node_.IsMap())
    FailAt(PlaceOf(node_, file_),
           fmt::format("{}'{}' is not allowed; allowed: keys with values", name, ValueText(node_)));
  for (const auto& entry : node_) {
    if (!entry.first.IsScalar()) FailAt(PlaceOf(entry.first, file_), name + "a key must be a plain word");
    const std::string& key = entry.first.Scalar();
    if (Has(key)) FailAt(PlaceOf(entry.first, file_), Name(key) + ": stands here twice");
    entries_.push_back({entry.first, entry.second, file_});
  }
}

TextPlace StrictMap::PlaceOf(const YAML::Node& node, const std::string& file) {
  const YAML::Mark mark = node.Mark();
  if (mark.is_null()) return {file};
  return {file, mark.line + 1, mark.column + 1};
}

std::string StrictMap::Name(std::string_view key) const { return path_ + std::string(key); }

const StrictMap::Entry* StrictMap::EntryOf(std::string_view key) const {
  const auto found = std::find_if(entries_.begin(), entries_.end(),
                                  [&](const Entry& entry) { return entry.key.Scalar() == key; });
  return found == entries_.end() ? nullptr : &*found;
}

const std::string& StrictMap::FileOf(std::string_view key) const {
  const Entry* entry = EntryOf(key);
  return entry ? entry->file : file_;
}

YAML::Node StrictMap::Find(std::string_view key) {
  asked_.emplace_back(key);
  const Entry* entry = EntryOf(key);
  return entry ? entry->value : YAML::Node(YAML::NodeType::Undefined);
}

void StrictMap::TakeOver(const StrictMap& base) {
  for (const Entry& entry : base.entries_)
    if (!Has(entry.key.Scalar())) entries_.push_back(entry);
}

bool StrictMap::Has(std::string_view key) const { return EntryOf(key) != nullptr; }

bool StrictMap::HasMap(std::string_view key) const {
  const Entry* entry = EntryOf(key);
  return entry && entry->value.IsMap();
}

TextPlace StrictMap::Place(std::string_view key) const {
  const Entry* entry = EntryOf(key);
  return entry ? PlaceOf(entry->value, entry->file) : PlaceOf(node_, file_);
}

void StrictMap::Fail(std::string_view key, const std::string& problem) const {
  FailAt(Place(key), fmt::format("{}: {}", Name(key), problem));
}

void StrictMap::Refuse(const YAML::Node& node, std::string_view key, const std::string& allowed) const {
  FailAt(PlaceOf(node, FileOf(key)),
         fmt::format("{}: '{}' is not allowed; allowed: {}", Name(key), ValueText(node), allowed));
}

double StrictMap::Number(const YAML::Node& node, std::string_view key, const AllowedRange& range) const {
  const std::optional<double> value = Parse<double>(node);
  if (!value || !std::isfinite(*value) || *value < range.min || *value > range.max)
    Refuse(node, key, RangeText(range));
  return *value;
}

std::vector<YAML::Node> StrictMap::List(const YAML::Node& node, std::string_view key, std::size_t min_count,
                                        std::size_t max_count, std::string_view of) const {
  const std::size_t count = node.IsSequence() ? node.size() : 0;
  if (!node.IsSequence() || count < min_count || count > max_count) {
    const std::string counts =
        min_count == max_count ? fmt::format("{}", min_count) : fmt::format("{} .. {}", min_count, max_count);
    const std::string found = node.IsSequence() ? fmt::format(" (here {})", count) : "";
    Refuse(node, key, fmt::format("a list of {} {}{}", counts, of, found));
  }
  return std::vector<YAML::Node>(node.begin(), node.end());
}

bool StrictMap::Read(std::string_view key, double& value, const AllowedRange& range) {
  const YAML::Node node = Find(key);
  if (!node.IsDefined()) return false;
  value = Number(node, key, range);
  return true;
}

bool StrictMap::Read(std::string_view key, int& value, const AllowedRange& range) {
  const YAML::Node node = Find(key);
  if (!node.IsDefined()) return false;
  const std::optional<int> parsed = Parse<int>(node);
  if (!parsed || *parsed < range.min || *parsed > range.max)
    Refuse(node, key, RangeText(range) + " (a whole number)");
  value = *parsed;
  return true;
}

bool StrictMap::Read(std::string_view key, std::uint64_t& value) {
  const YAML::Node node = Find(key);
  if (!node.IsDefined()) return false;
  const std::optional<std::uint64_t> parsed = Parse<std::uint64_t>(node);
  if (!parsed) Refuse(node, key, "0 .. 18446744073709551615 (a whole number)");
  value = *parsed;
  return true;
}

bool StrictMap::Read(std::string_view key, bool& value) {
  const YAML::Node node = Find(key);
  if (!node.IsDefined()) return false;
  const std::string text = node.IsScalar() ? node.Scalar() : "";
  if (text != "true" && text != "false") Refuse(node, key, "true | false");
  value = text == "true";
  return true;
}

bool StrictMap::Read(std::string_view key, std::string& value) {
  const YAML::Node node = Find(key);
  if (!node.IsDefined()) return false;
  if (!node.IsScalar() || node.Scalar().empty() || node.Scalar().find('\n') != std::string::npos)
    Refuse(node, key, "text");
  value = node.Scalar();
  return true;
}

bool StrictMap::Read(std::string_view key, std::vector<double>& value, std::size_t min_count,
                     std::size_t max_count, const AllowedRange& range) {
  const YAML::Node node = Find(key);
  if (!node.IsDefined()) return false;
  value.clear();
  for (const YAML::Node& item : List(node, key, min_count, max_count, "numbers"))
    value.push_back(Number(item, key, range));
  return true;
}

bool StrictMap::Read(std::string_view key, Eigen::Vector2d& value, const AllowedRange& range) {
  std::vector<double> pair;
  if (!Read(key, pair, 2, 2, range)) return false;
  value = {pair[0], pair[1]};
  return true;
}

bool StrictMap::Read(std::string_view key, std::vector<Eigen::Vector2d>& value, std::size_t min_count,
                     std::size_t max_count, const AllowedRange& range) {
  const YAML::Node node = Find(key);
  if (!node.IsDefined()) return false;
  value.clear();
  for (const YAML::Node& point : List(node, key, min_count, max_count, "points [x, y]")) {
    const std::vector<YAML::Node> pair = List(point, key, 2, 2, "numbers");
    value.emplace_back(Number(pair[0], key, range), Number(pair[1], key, range));
  }
  return true;
}

std::optional<StrictMap> StrictMap::ReadMap(std::string_view key) {
  const YAML::Node node = Find(key);
  if (!node.IsDefined()) return std::nullopt;
  return StrictMap(node, FileOf(key), Name(key) + ".");
}

std::optional<StrictMap> StrictMap::RequireMap(std::string_view key) {
  std::optional<StrictMap> map = ReadMap(key);
  if (!map) missing_.emplace_back(key);
  return map;
}

std::vector<StrictMap> StrictMap::RequireMaps(std::string_view key, std::size_t min_count,
                                              std::size_t max_count) {
  const YAML::Node node = Find(key);
  std::vector<StrictMap> maps;
  if (!node.IsDefined()) {
    missing_.emplace_back(key);
    return maps;
  }
  for (const YAML::Node& item : List(node, key, min_count, max_count, "entries"))
    maps.push_back(StrictMap(item, FileOf(key), fmt::format("{}[{}].", Name(key), maps.size() + 1)));
  return maps;
}

void StrictMap::RequireOneOf(std::string_view a, std::string_view b) {
  if (Has(a) && Has(b)) Fail(b, fmt::format("is not allowed together with {}", Name(a)));
  if (!Has(a) && !Has(b)) missing_.push_back(fmt::format("{} or {}", a, b));
}

void StrictMap::Finish() const {
  for (const Entry& entry : entries_) {
    const std::string& key = entry.key.Scalar();
    if (std::find(asked_.begin(), asked_.end(), key) != asked_.end()) continue;
    const std::string nearest = NearestWord(key, asked_);
    const std::string hint = nearest.empty() ? fmt::format("known here: {}", fmt::join(asked_, ", "))
                                             : fmt::format("did you mean {}?", Name(nearest));
    FailAt(PlaceOf(entry.key, entry.file), fmt::format("{}: unknown key; {}", Name(key), hint));
  }
  if (!missing_.empty()) FailAt(PlaceOf(node_, file_), fmt::format("{}: is missing", Name(missing_.front())));
}

}  // namespace ed3r
