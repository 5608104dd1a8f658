#include "engine/world/files/raster_neighbours.h"

#include <cpl_minixml.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <map>
#include <string_view>
#include <vector>

#include "engine/core/files/file.h"
#include "engine/world/files/quiet_gdal.h"

namespace ed3r::world {
namespace {

std::string LowerCase(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

bool WouldWait(std::filesystem::file_type type) {
  using Type = std::filesystem::file_type;
  return type == Type::fifo || type == Type::socket || type == Type::character;
}

// GDAL reads the first element alone, and hides what it finds wrong.
bool IsUnderstood(const std::filesystem::path& aux_xml) {
  const QuietGdal quiet;
  CPLXMLNode* const tree = CPLParseXMLFile(aux_xml.c_str());
  const bool understood =
      tree != nullptr && std::string_view(tree->pszValue) == "PAMDataset" && quiet.Complaint().empty();
  CPLDestroyXMLNode(tree);
  return understood;
}

// The file itself, and what a link leads to, one after another.
std::vector<std::filesystem::path> NamesAlongLinks(const std::filesystem::path& file) {
  const auto in_its_folder = [](const std::filesystem::path& name) {
    return std::filesystem::canonical(name.parent_path()) / name.filename();
  };
  std::vector<std::filesystem::path> names = {in_its_folder(std::filesystem::absolute(file))};
  while (std::filesystem::is_symlink(names.back()))
    names.push_back(in_its_folder(names.back().parent_path() / std::filesystem::read_symlink(names.back())));
  return names;
}

// By their endings in lower case.
std::map<std::string, std::filesystem::path> Neighbours(const std::filesystem::path& file) {
  constexpr std::array<std::string_view, 6> kForEnding = {".prj", ".tfw", ".tifw", ".tiffw", ".wld", ".tab"};
  constexpr std::array<std::string_view, 3> kForName = {".aux.xml", ".msk", ".xml"};
  std::map<std::string, std::filesystem::path> found;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(file.parent_path(), error)) {
    const std::string name = entry.path().filename().string();
    const auto add = [&](const std::string& begin, const auto& endings) {
      if (!name.starts_with(begin)) return;
      const std::string ending = LowerCase(name.substr(begin.size()));
      if (std::find(endings.begin(), endings.end(), ending) != endings.end()) found[ending] = entry.path();
    };
    add(file.stem().string(), kForEnding);
    add(file.filename().string(), kForName);
  }
  return found;
}

bool IsNameSign(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-' || c == ':';
}

// What stands in the elements and keys of XML, JSON and WKT that are called so.
std::vector<std::string> TextsCalledUnit(const std::string& text) {
  constexpr std::size_t kLongest = 60, kLongestTag = 2000, kLongestSystem = 400;
  const std::string lower = LowerCase(text);
  const auto in_vertical_system = [&](std::size_t at) {  // others tell the unit of lengths
    const std::size_t before = std::min(at, kLongestSystem);
    return std::string_view(lower).substr(at - before, before).find("vertcs") != std::string_view::npos;
  };
  std::vector<std::string> found;
  for (std::size_t at = lower.find("unit"), end = 0; at != std::string::npos; at = lower.find("unit", end)) {
    std::size_t begin = end = at;
    while (begin > 0 && IsNameSign(lower[begin - 1])) --begin;
    while (end < lower.size() && IsNameSign(lower[end])) ++end;
    if (begin == 0 || end == lower.size() ||
        !IsCalledUnit(std::string_view(lower).substr(begin, end - begin)))
      continue;
    std::size_t value = std::string::npos;
    if (lower[begin - 1] == '<') value = std::string_view(lower).substr(0, end + kLongestTag).find('>', end);
    if (lower[begin - 1] == '"' && lower[end] == '"') value = lower.find_first_not_of(" \t\r\n:[", end + 1);
    if (lower[end] == '[' && in_vertical_system(at)) value = end;
    if (value == std::string::npos) continue;
    const std::string_view rest = std::string_view(text).substr(value + 1, kLongest);
    found.emplace_back(
        rest.substr(0, std::min(rest.find_first_of(lower[end] == '[' ? ",]" : "<\""), rest.size())));
  }
  return found;
}

bool AreAlike(const std::filesystem::path& a, const std::filesystem::path& b) {
  return std::filesystem::equivalent(a, b) ||
         ReadFile(a.string(), kMaxModelBytes) == ReadFile(b.string(), kMaxModelBytes);
}

}  // namespace

bool IsCalledUnit(std::string_view name) {
  constexpr std::array<std::string_view, 5> kEnds = {"unit", "units", "unittype", "unitsymbol", "unitname"};
  const std::string lower = LowerCase(std::string(name));
  const bool of_pixels = lower.find("resolution") != std::string::npos;  // for paper: pixels/inch
  return !of_pixels &&
         std::any_of(kEnds.begin(), kEnds.end(), [&](std::string_view end) { return lower.ends_with(end); });
}

RasterName NameWithNeighbours(const std::filesystem::path& file) {
  const std::vector<std::filesystem::path> names = NamesAlongLinks(file);
  RasterName best;
  std::map<std::string, std::filesystem::path> all, best_has;
  for (const std::filesystem::path& name : names) {
    if (std::string problem = WhyNeighboursCannotBeRead(name); !problem.empty()) return {name, problem};
    const std::map<std::string, std::filesystem::path> has = Neighbours(name);
    for (const auto& [ending, path] : has) {
      if (std::error_code error; !std::filesystem::is_regular_file(path, error))
        return {name, fmt::format("beside it stands {}, which is no file, or a link that leads to none",
                                  path.filename().string())};
      if (const auto known = all.emplace(ending, path).first; !AreAlike(known->second, path))
        return {name, fmt::format("it is a link, and '{}' is not the same as '{}' beside what it leads to; "
                                  "make them alike, or take one away",
                                  known->second.string(), path.string())};
    }
    if (has.size() < best_has.size()) continue;
    best.file = name;
    best_has = has;
  }
  for (const auto& [ending, path] : all)
    if (!best_has.contains(ending))
      best.problem = fmt::format(
          "it is a link, and what belongs to it stands in two places, '{}' and '{}'; bring all to one: "
          "beside the link, or beside what it leads to",
          best_has.begin()->second.string(), path.string());
  return best;
}

std::string WhyNeighboursCannotBeRead(const std::filesystem::path& file) {
  const std::string stem = file.stem().string(), aux_xml = file.filename().string() + ".aux.xml";
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(file.parent_path(), error)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with(stem) && WouldWait(entry.status(error).type()))
      return fmt::format("beside it stands {}, which is no file", name);
    if (LowerCase(name) != LowerCase(aux_xml)) continue;
    if (name != aux_xml)
      return fmt::format("beside it stands {}, which is not read under that name; call it {}", name, aux_xml);
    if (!IsUnderstood(entry.path()))
      return fmt::format(
          "beside it stands {}, which is not understood; allowed: XML that begins with <PAMDataset>, whole; "
          "mend it, or take it away",
          name);
  }
  return "";
}

std::vector<MetadataUnit> UnitsOfMetadata(const std::filesystem::path& file) {
  constexpr std::array<std::string_view, 3> kEndings = {".xml", ".json", ".aux.json"};
  std::vector<MetadataUnit> units;
  for (const std::filesystem::path& raster : NamesAlongLinks(file)) {
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator(raster.parent_path(), error)) {
      const std::string name = entry.path().filename().string();
      const bool beside = std::any_of(kEndings.begin(), kEndings.end(), [&](std::string_view ending) {
        const auto is = [&](const std::filesystem::path& begin) {
          return LowerCase(name) == LowerCase(begin.string()).append(ending);
        };
        return is(raster.stem()) || is(raster.filename());
      });
      if (!beside || !entry.is_regular_file(error)) continue;
      for (const std::string& text : TextsCalledUnit(ReadFile(entry.path().string(), kMaxModelBytes)))
        units.push_back({name, text});
    }
  }
  return units;
}

std::string MaskBeside(const std::filesystem::path& file) {
  const std::string mask = LowerCase(file.filename().string() + ".msk");
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(file.parent_path(), error)) {
    std::string name = entry.path().filename().string();
    if (LowerCase(name) == mask) return name;
  }
  return "";
}

}  // namespace ed3r::world
