#include "engine/world/raster_neighbours.h"

#include <cpl_minixml.h>
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <string_view>

#include "engine/world/quiet_gdal.h"

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

}  // namespace

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
