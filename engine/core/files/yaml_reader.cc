#include "engine/core/files/yaml_reader.h"

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <sstream>

#include "engine/core/check.h"
#include "engine/core/files/end_mark.h"
#include "engine/core/files/file.h"
#include "engine/core/files/line_ends.h"
#include "engine/core/files/utf8.h"
#include "engine/core/message.h"
#include "engine/core/parse_number.h"
#include "engine/core/suggest.h"

namespace ed3r {
namespace {

bool IsControl(char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }

// Checked before the YAML parser sees the text: it would guess encodings and accept raw bytes.
void CheckText(const std::string& file, std::string_view text) {
  int line = 1;
  std::size_t line_start = 0;
  for (std::size_t i = 0; i < text.size();) {
    const char c = text[i];
    const std::size_t length = Utf8Length(text.substr(i));
    if (length == 0 || (IsControl(c) && c != '\n' && c != '\r' && c != '\t'))
      FailAt(fmt::format("{}:{}:{}", file, line, i - line_start + 1),
             fmt::format("byte 0x{:02x} is not allowed; a YAML file is UTF-8 text",
                         static_cast<unsigned>(static_cast<unsigned char>(c))));
    if (c == '\t' && text.find_first_not_of(' ', line_start) == i)
      FailAt(fmt::format("{}:{}:{}", file, line, i - line_start + 1),
             "a tab is not allowed; indent with spaces");
    i += length;
    if (c == '\n') {
      ++line;
      line_start = i;
    }
  }
}

std::string FirstComment(std::string_view text) {
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  const std::size_t start = text.find_first_not_of(" \t\r\n");
  if (start == std::string_view::npos || text[start] != '#') return "";
  std::string_view line = text.substr(start, text.find('\n', start) - start);
  line.remove_prefix(std::min(line.find_first_not_of("# \t"), line.size()));
  const std::size_t end = line.find_last_not_of(" \t\r");
  return end == std::string_view::npos ? "" : std::string(line.substr(0, end + 1));
}

// Turns the parser's events into the tree. yaml-cpp's own tree is not used: it drops duplicate keys without a
// word and cannot tell an alias from a copy.
class TreeBuilder : public YAML::EventHandler {
 public:
  explicit TreeBuilder(const std::string& file) : file_(file) {}

  YamlNode TakeRoot() { return std::move(root_); }
  int Documents() const { return documents_; }
  const std::string& LastDocumentAt() const { return document_at_; }

  void OnDocumentStart(const YAML::Mark& mark) override {
    ++documents_;
    document_at_ = At(mark);
  }
  void OnDocumentEnd() override {}

  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    YamlNode node = Made(YamlNode::Kind::kNull, mark, "", anchor);
    // An empty value has no place of its own: point at its key.
    if (!open_.empty() && open_.back().key) node.at = open_.back().key_at;
    Add(std::move(node));
  }

  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override { FailAt(At(mark), kNoAnchors); }

  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    YamlNode node = Made(YamlNode::Kind::kScalar, mark, tag, anchor);
    node.text = value.substr(0, value.find_last_not_of('\n') + 1);  // a block scalar ends with a line break
    if (std::any_of(node.text.begin(), node.text.end(), IsControl))
      FailAt(node.at, "a value of several lines or with control characters is not allowed");
    if (node.text.size() > kMaxScalarLength)
      FailAt(node.at, fmt::format("a value of {} bytes is not allowed; allowed: at most {}", node.text.size(),
                                  kMaxScalarLength));
    Add(std::move(node));
  }

  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    Open(Made(YamlNode::Kind::kList, mark, tag, anchor));
  }
  void OnSequenceEnd() override { Close(); }

  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    Open(Made(YamlNode::Kind::kMap, mark, tag, anchor));
  }
  void OnMapEnd() override { Close(); }

 private:
  static constexpr std::string_view kNoAnchors = "anchors and aliases are not allowed; write the value out";

  struct OpenNode {
    YamlNode node;
    std::optional<std::string> key;  // of the value that comes next
    std::string key_at;
    std::map<std::string, std::string> key_places;
  };

  std::string At(const YAML::Mark& mark) const {
    return fmt::format("{}:{}:{}", file_, mark.line + 1, mark.column + 1);
  }

  YamlNode Made(YamlNode::Kind kind, const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor) {
    YamlNode node;
    node.kind = kind;
    node.at = At(mark);
    if (anchor != 0) FailAt(node.at, kNoAnchors);
    if (!tag.empty() && tag != "?" && tag != "!")
      FailAt(node.at, fmt::format("tag '{}' is not allowed", tag));
    return node;
  }

  bool AwaitsKey() const {
    return !open_.empty() && open_.back().node.kind == YamlNode::Kind::kMap && !open_.back().key;
  }

  void Open(YamlNode node) {
    if (AwaitsKey())
      FailAt(node.at, fmt::format("{} is not allowed as a key; allowed: a word", Described(node)));
    open_.push_back({std::move(node), std::nullopt, "", {}});
  }

  void Close() {
    YamlNode node = std::move(open_.back().node);
    open_.pop_back();
    Add(std::move(node));
  }

  void Add(YamlNode node) {
    if (open_.empty()) {
      root_ = std::move(node);
      return;
    }
    OpenNode& parent = open_.back();
    if (parent.node.kind == YamlNode::Kind::kList) {
      parent.node.items.push_back(std::move(node));
    } else if (parent.key) {
      parent.node.entries.push_back({std::move(*parent.key), parent.key_at, std::move(node)});
      parent.key.reset();
    } else {
      SetKey(parent, std::move(node));
    }
  }

  static void SetKey(OpenNode& map, YamlNode node) {
    if (node.kind != YamlNode::Kind::kScalar || node.text.empty())
      FailAt(node.at, "an empty key is not allowed; allowed: a word");
    const auto [first, is_new] = map.key_places.emplace(node.text, node.at);
    if (!is_new)
      FailAt(node.at, fmt::format("{}: duplicate key; it stands first at {}", node.text, first->second));
    map.key = std::move(node.text);
    map.key_at = std::move(node.at);
  }

  std::string file_;
  std::vector<OpenNode> open_;
  YamlNode root_;
  int documents_ = 0;
  std::string document_at_;
};

}  // namespace

YamlFile ReadYamlFile(const std::string& file) { return ParseYaml(file, ReadFile(file, kMaxYamlFileLength)); }

// yaml-cpp does not end a comment at a lone carriage return: the setting after it would vanish.
YamlFile ParseYaml(const std::string& file, const std::string& as_written) {
  const std::string text = WithLineFeeds(as_written);
  CheckText(file, text);
  if (IsCutShort(text))
    FailAt(file, fmt::format("is cut short: its last line, '{}', is missing; write it anew", kEndMark));
  TreeBuilder tree(file);
  try {
    std::istringstream in(text);
    YAML::Parser parser(in);
    while (parser.HandleNextDocument(tree)) {
      if (tree.Documents() > 1)
        FailAt(tree.LastDocumentAt(), "a second document is not allowed; a file holds one");
    }
  } catch (const YAML::Exception& error) {
    if (error.mark.is_null()) FailAt(file, "not valid YAML: " + error.msg);
    FailAt(fmt::format("{}:{}:{}", file, error.mark.line + 1, error.mark.column + 1),
           "not valid YAML: " + error.msg);
  }
  YamlFile result{FirstComment(text), tree.TakeRoot()};
  if (result.root.at.empty()) result.root.at = file + ":1:1";
  return result;
}

void FailAt(std::string_view at, std::string_view clause) {
  throw UserError(OneLine(fmt::format("{}: {}", at, clause)));
}

std::string Described(const YamlNode& node) {
  switch (node.kind) {
    case YamlNode::Kind::kNull:
      return "nothing";
    case YamlNode::Kind::kScalar:
      return fmt::format("'{}'", node.text);
    case YamlNode::Kind::kList:
      return "a list";
    case YamlNode::Kind::kMap:
      return "a map";
  }
  FailCheck(__FILE__, __LINE__, "known kind of node", node.at);
}

void ExpectKeys(const YamlNode& node, std::string_view what, const std::vector<std::string>& known) {
  if (node.kind != YamlNode::Kind::kMap)
    FailAt(node.at, fmt::format("{}: {} is not allowed; allowed: a map with the keys {}", what,
                                Described(node), Joined(known)));
  for (const YamlEntry& entry : node.entries) {
    if (std::find(known.begin(), known.end(), entry.key) != known.end()) continue;
    const std::string nearest = NearestWord(entry.key, known);
    FailAt(entry.at, nearest.empty()
                         ? fmt::format("{}: unknown key; {} has {}", entry.key, what, Joined(known))
                         : fmt::format("{}: unknown key; did you mean {}?", entry.key, nearest));
  }
}

const YamlNode* Find(const YamlNode& map, std::string_view key) {
  for (const YamlEntry& entry : map.entries)
    if (entry.key == key) return &entry.value;
  return nullptr;
}

const std::string& TextOf(const YamlNode& node, std::string_view key) {
  if (node.kind != YamlNode::Kind::kScalar)
    FailAt(node.at, fmt::format("{}: {} is not allowed; allowed: one value", key, Described(node)));
  return node.text;
}

std::uint64_t WholeNumberOf(const YamlNode& node, std::string_view key, std::uint64_t min,
                            std::uint64_t max) {
  const std::string& text = TextOf(node, key);
  const auto value = ParseNumber<std::uint64_t>(text);
  if (!value || *value < min || *value > max)
    FailAt(node.at, fmt::format("{}: '{}' is not allowed; allowed: {} .. {}", key, text, min, max));
  return *value;
}

double PositiveNumberOf(const YamlNode& node, std::string_view key) {
  const std::string& text = TextOf(node, key);
  const auto value = ParseNumber<double>(text);
  if (!value || !(*value > 0.0) || !std::isfinite(*value))
    FailAt(node.at, fmt::format("{}: '{}' is not allowed; allowed: a number above 0", key, text));
  return *value;
}

const std::string& NameOfThing(const YamlNode& node, std::string_view key) {
  constexpr std::size_t kMaxNameLength = 64;
  const auto is_letter_or_digit = [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
  };
  const std::string& name = TextOf(node, key);
  const bool good = !name.empty() && name.size() <= kMaxNameLength && is_letter_or_digit(name[0]) &&
                    std::all_of(name.begin(), name.end(), [&](char c) {
                      return is_letter_or_digit(c) || std::string_view("._-+").find(c) != std::string::npos;
                    });
  if (!good)
    FailAt(node.at, fmt::format("{}: '{}' is not allowed; allowed: at most {} letters, digits and . _ - +, "
                                "the first a letter or digit",
                                key, name, kMaxNameLength));
  return name;
}

std::string Joined(const std::vector<std::string>& words) {
  return fmt::format("{}", fmt::join(words, ", "));
}

}  // namespace ed3r
