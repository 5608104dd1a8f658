#include "engine/world/files/strict_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/core/check.h"
#include "engine/core/parse_number.h"
#include "engine/core/suggest.h"

namespace ed3r::world {
namespace {

std::string RangeText(const AllowedRange& range) {
  return fmt::format("{:g} .. {:g}{}{}", range.min, range.max, range.unit.empty() ? "" : " ", range.unit);
}

// A value as the file shows it, short enough for one line.
std::string ValueText(const YamlNode& node) {
  if (node.kind == YamlNode::Kind::kList) return "[...]";
  if (node.kind == YamlNode::Kind::kMap) return "{...}";
  return node.text.size() > 60 ? node.text.substr(0, 57) + "..." : node.text;
}

template <class T>
std::optional<T> Parse(const YamlNode& node) {
  if (node.kind != YamlNode::Kind::kScalar) return std::nullopt;
  return ParseNumber<T>(WithoutPlus(node.text));
}

}  // namespace

StrictMap StrictMap::FromFile(const std::string& file) {
  return StrictMap(std::make_shared<const YamlNode>(ReadYamlFile(file).root), "");
}

// `node` shares the ownership of the file's whole tree.
StrictMap::StrictMap(std::shared_ptr<const YamlNode> node, std::string path)
    : node_(std::move(node)), path_(std::move(path)) {
  const std::string name = path_.empty() ? "" : path_.substr(0, path_.size() - 1) + ": ";
  if (node_->kind != YamlNode::Kind::kMap)
    FailAt(node_->at,
           fmt::format("{}'{}' is not allowed; allowed: keys with values", name, ValueText(*node_)));
}

StrictMap StrictMap::Inside(std::string_view key, const YamlNode& node, std::string path) const {
  return StrictMap(std::shared_ptr<const YamlNode>(TreeOf(key), &node), std::move(path));
}

const std::shared_ptr<const YamlNode>& StrictMap::TreeOf(std::string_view key) const {
  for (const std::shared_ptr<const YamlNode>& base : bases_)
    if (ed3r::Find(*node_, key) == nullptr && ed3r::Find(*base, key) != nullptr) return base;
  return node_;
}

std::string StrictMap::Name(std::string_view key) const { return path_ + std::string(key); }

const YamlNode* StrictMap::Find(std::string_view key) {
  asked_.emplace_back(key);
  return ValueOf(key);
}

const YamlNode* StrictMap::ValueOf(std::string_view key) const { return ed3r::Find(*TreeOf(key), key); }

void StrictMap::TakeOver(const StrictMap& base) {
  bases_.push_back(base.node_);
  bases_.insert(bases_.end(), base.bases_.begin(), base.bases_.end());
}

bool StrictMap::Has(std::string_view key) const { return ValueOf(key) != nullptr; }

bool StrictMap::HasMap(std::string_view key) const {
  const YamlNode* node = ValueOf(key);
  return node != nullptr && node->kind == YamlNode::Kind::kMap;
}

std::string StrictMap::File() const {
  const std::size_t column = node_->at.rfind(':');
  return node_->at.substr(0, node_->at.rfind(':', column - 1));
}

TextPlace StrictMap::Place(std::string_view key) const {
  const YamlNode* node = ValueOf(key);
  return node != nullptr ? node->at : node_->at;
}

void StrictMap::Fail(std::string_view key, const std::string& problem) const {
  FailAt(Place(key), fmt::format("{}: {}", Name(key), problem));
}

void StrictMap::Refuse(const YamlNode& node, std::string_view key, const std::string& allowed) const {
  FailAt(node.at, fmt::format("{}: '{}' is not allowed; allowed: {}", Name(key), ValueText(node), allowed));
}

double StrictMap::Number(const YamlNode& node, std::string_view key, const AllowedRange& range) const {
  const std::optional<double> value = Parse<double>(node);
  if (!value || !std::isfinite(*value) || *value < range.min || *value > range.max)
    Refuse(node, key, RangeText(range));
  return *value;
}

const std::vector<YamlNode>& StrictMap::List(const YamlNode& node, std::string_view key,
                                             std::size_t min_count, std::size_t max_count,
                                             std::string_view of) const {
  const bool is_list = node.kind == YamlNode::Kind::kList;
  const std::size_t count = node.items.size();
  if (!is_list || count < min_count || count > max_count) {
    const std::string counts =
        min_count == max_count ? fmt::format("{}", min_count) : fmt::format("{} .. {}", min_count, max_count);
    const std::string found = is_list ? fmt::format(" (here {})", count) : "";
    Refuse(node, key, fmt::format("a list of {} {}{}", counts, of, found));
  }
  return node.items;
}

bool StrictMap::Read(std::string_view key, double& value, const AllowedRange& range) {
  const YamlNode* node = Find(key);
  if (node == nullptr) return false;
  value = Number(*node, key, range);
  return true;
}

bool StrictMap::Read(std::string_view key, int& value, const AllowedRange& range) {
  const YamlNode* node = Find(key);
  if (node == nullptr) return false;
  const std::optional<int> parsed = Parse<int>(*node);
  if (!parsed || *parsed < range.min || *parsed > range.max)
    Refuse(*node, key, RangeText(range) + " (a whole number)");
  value = *parsed;
  return true;
}

bool StrictMap::Read(std::string_view key, std::uint64_t& value) {
  const YamlNode* node = Find(key);
  if (node == nullptr) return false;
  const std::optional<std::uint64_t> parsed = Parse<std::uint64_t>(*node);
  if (!parsed) Refuse(*node, key, "0 .. 18446744073709551615 (a whole number)");
  value = *parsed;
  return true;
}

bool StrictMap::Read(std::string_view key, bool& value) {
  const YamlNode* node = Find(key);
  if (node == nullptr) return false;
  const std::string& text = node->text;
  if (text != "true" && text != "false") Refuse(*node, key, "true | false");
  value = text == "true";
  return true;
}

bool StrictMap::Read(std::string_view key, std::string& value) {
  const YamlNode* node = Find(key);
  if (node == nullptr) return false;
  if (node->kind != YamlNode::Kind::kScalar || node->text.empty()) Refuse(*node, key, "text");
  value = node->text;
  return true;
}

bool StrictMap::Read(std::string_view key, std::vector<double>& value, std::size_t min_count,
                     std::size_t max_count, const AllowedRange& range) {
  const YamlNode* node = Find(key);
  if (node == nullptr) return false;
  value.clear();
  for (const YamlNode& item : List(*node, key, min_count, max_count, "numbers"))
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
  const YamlNode* node = Find(key);
  if (node == nullptr) return false;
  value.clear();
  for (const YamlNode& point : List(*node, key, min_count, max_count, "points [x, y]")) {
    const std::vector<YamlNode>& pair = List(point, key, 2, 2, "numbers");
    value.emplace_back(Number(pair[0], key, range), Number(pair[1], key, range));
  }
  return true;
}

std::optional<StrictMap> StrictMap::ReadMap(std::string_view key) {
  const YamlNode* node = Find(key);
  if (node == nullptr) return std::nullopt;
  return Inside(key, *node, Name(key) + ".");
}

std::optional<StrictMap> StrictMap::RequireMap(std::string_view key) {
  std::optional<StrictMap> map = ReadMap(key);
  if (!map) missing_.emplace_back(key);
  return map;
}

std::vector<StrictMap> StrictMap::RequireMaps(std::string_view key, std::size_t min_count,
                                              std::size_t max_count) {
  const YamlNode* node = Find(key);
  std::vector<StrictMap> maps;
  if (node == nullptr) {
    missing_.emplace_back(key);
    return maps;
  }
  for (const YamlNode& item : List(*node, key, min_count, max_count, "entries"))
    maps.push_back(Inside(key, item, fmt::format("{}[{}].", Name(key), maps.size() + 1)));
  return maps;
}

void StrictMap::RequireOneOf(std::string_view a, std::string_view b) {
  if (Has(a) && Has(b)) Fail(b, fmt::format("is not allowed together with {}", Name(a)));
  if (!Has(a) && !Has(b)) missing_.push_back(fmt::format("{} or {}", a, b));
}

void StrictMap::Finish() const {
  std::vector<const YamlNode*> maps = {node_.get()};
  for (const std::shared_ptr<const YamlNode>& base : bases_) maps.push_back(base.get());
  for (const YamlNode* map : maps) {
    for (const YamlEntry& entry : map->entries) {
      if (std::find(asked_.begin(), asked_.end(), entry.key) != asked_.end()) continue;
      const std::string nearest = NearestWord(entry.key, asked_);
      const std::string hint = nearest.empty() ? fmt::format("known here: {}", fmt::join(asked_, ", "))
                                               : fmt::format("did you mean {}?", Name(nearest));
      FailAt(entry.at, fmt::format("{}: unknown key; {}", Name(entry.key), hint));
    }
  }
  if (!missing_.empty()) FailAt(node_->at, fmt::format("{}: is missing", Name(missing_.front())));
}

}  // namespace ed3r::world
