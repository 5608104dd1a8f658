// YAML files read strictly: a plain tree in which every node knows where it stands, so that each later check
// can point at the line and column that it refuses.
//
// Refused here, beyond YAML's own syntax: a key that is given twice, keys that are lists or maps, anchors and
// aliases (and with them merge keys), tags, a second document, values of more than one line or of more than
// kMaxScalarLength bytes, control characters, and text that is not UTF-8.
// Errors: UserError, one line "file:line:column: ...". Threads: nothing is shared.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace ed3r {

constexpr std::size_t kMaxScalarLength = 1000;
constexpr std::size_t kMaxYamlFileLength = 1 << 20;

struct YamlEntry;

struct YamlNode {
  enum class Kind { kNull, kScalar, kList, kMap };
  Kind kind = Kind::kNull;
  std::string at;                  // "file:line:column", 1-based, columns in bytes
  std::string text;                // of a scalar
  std::vector<YamlNode> items;     // of a list
  std::vector<YamlEntry> entries;  // of a map, in the order written
};

struct YamlEntry {
  std::string key;
  std::string at;
  YamlNode value;
};

struct YamlFile {
  std::string first_comment;  // the comment on the first line that is not blank; "" when there is none
  YamlNode root;
};

YamlFile ReadYamlFile(const std::string& file);

// The same from text; `file` names it in messages.
YamlFile ParseYaml(const std::string& file, const std::string& text);

// Throws UserError "at: clause", as one line (message.h).
[[noreturn]] void FailAt(std::string_view at, std::string_view clause);

// What a node is, for messages: "'text'", "a list", "a map", "nothing".
std::string Described(const YamlNode& node);

// Refuses a node that is not a map, and keys outside `known`; `what` names the map in the message.
void ExpectKeys(const YamlNode& node, std::string_view what, const std::vector<std::string>& known);

// The value of a key, or null when the map does not have it.
const YamlNode* Find(const YamlNode& map, std::string_view key);

// The text of a scalar; `key` names it in the message.
const std::string& TextOf(const YamlNode& node, std::string_view key);

// A whole number in [min, max].
std::uint64_t WholeNumberOf(const YamlNode& node, std::string_view key, std::uint64_t min, std::uint64_t max);

// A finite number above 0.
double PositiveNumberOf(const YamlNode& node, std::string_view key);

// A name that may stand in a path or a table: letters, digits, '.', '_', '-', '+'; starts with a letter or
// digit; at most 64 characters.
const std::string& NameOfThing(const YamlNode& node, std::string_view key);

// "a, b, c"
std::string Joined(const std::vector<std::string>& words);

}  // namespace ed3r
