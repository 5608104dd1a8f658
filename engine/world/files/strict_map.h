// A YAML mapping that is read strictly: every key must be known, and its value must lie in the allowed range; what
// engine/core/files/yaml_reader.h refuses (keys twice, tags, anchors, other text than UTF-8, ...) does not come this far.
// All errors are UserErrors of one line, "file:line:column: key: what is wrong".
//
//   StrictMap map = StrictMap::FromFile("world.yaml");
//   map.Require("cell_m", spec.cell_m, {.min = 0.5, .max = 20, .unit = "m"});
//   map.Read("roughness", spec.roughness, {.min = 0, .max = 1});   // keeps its value when the key is absent
//   map.Finish();
//
// A key that is never asked for is unknown, and Finish() says so (with the nearest key that was asked for)
// before it complains about a required key that is missing: a misspelt key is both, and the first helps more.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/world/files/text_place.h"

namespace ed3r::world {

struct AllowedRange {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  std::string_view unit{};
};

class StrictMap {
 public:
  static StrictMap FromFile(const std::string& file);

  // Each returns whether the key is there.
  bool Read(std::string_view key, double& value, const AllowedRange& range);
  bool Read(std::string_view key, int& value, const AllowedRange& range);
  bool Read(std::string_view key, std::uint64_t& value);
  bool Read(std::string_view key, bool& value);
  bool Read(std::string_view key, std::string& value);  // not empty
  bool Read(std::string_view key, std::vector<double>& value, std::size_t min_count, std::size_t max_count,
            const AllowedRange& range);  // [a, b, ...]
  bool Read(std::string_view key, Eigen::Vector2d& value, const AllowedRange& range);
  bool Read(std::string_view key, std::vector<Eigen::Vector2d>& value, std::size_t min_count,
            std::size_t max_count, const AllowedRange& range);  // [[x, y], ...]

  template <class... Arguments>
  void Require(std::string_view key, Arguments&&... arguments) {
    if (!Read(key, std::forward<Arguments>(arguments)...)) missing_.emplace_back(key);
  }

  // A mapping inside, or a list of mappings; Finish() each of them too.
  std::optional<StrictMap> ReadMap(std::string_view key);
  std::optional<StrictMap> RequireMap(std::string_view key);
  std::vector<StrictMap> RequireMaps(std::string_view key, std::size_t min_count, std::size_t max_count);

  // Takes over every key of another mapping that does not stand here; errors in them name their own file.
  void TakeOver(const StrictMap& base);

  bool Has(std::string_view key) const;
  bool HasMap(std::string_view key) const;  // the key is there and its value is a mapping
  std::string File() const;                 // in which this mapping stands

  // Fails at the key's value, or at the mapping when the key is absent.
  [[noreturn]] void Fail(std::string_view key, const std::string& problem) const;
  TextPlace Place(std::string_view key) const;

  void RequireOneOf(std::string_view a, std::string_view b);  // exactly one
  void Finish() const;

 private:
  StrictMap(std::shared_ptr<const YamlNode> node, std::string path);
  StrictMap Inside(std::string_view key, const YamlNode& node, std::string path) const;

  const YamlNode* Find(std::string_view key);
  const YamlNode* ValueOf(std::string_view key) const;                        // null when the key is absent
  const std::shared_ptr<const YamlNode>& TreeOf(std::string_view key) const;  // where it stands, or this one
  std::string Name(std::string_view key) const;                               // with the path that leads here
  double Number(const YamlNode& node, std::string_view key, const AllowedRange& range) const;
  const std::vector<YamlNode>& List(const YamlNode& node, std::string_view key, std::size_t min_count,
                                    std::size_t max_count, std::string_view of) const;
  [[noreturn]] void Refuse(const YamlNode& node, std::string_view key, const std::string& allowed) const;

  std::shared_ptr<const YamlNode> node_;
  std::vector<std::shared_ptr<const YamlNode>> bases_;  // taken over: the nearest first
  std::string path_;                                    // "" or "terrain.grid."
  std::vector<std::string> asked_;
  std::vector<std::string> missing_;
};

}  // namespace ed3r::world
