#include "studies/report/web_page.h"

#include <fmt/format.h>

#include "engine/core/files/file.h"
#include "engine/core/files/shipped.h"
#include "engine/core/json_text.h"
#include "studies/report/page_parts.h"

namespace ed3r::report {
namespace {

// Only strings of a JSON text hold '<', and there it may be written as an escape: no text ends the element that holds it.
std::string ScriptSafe(const std::string& json) {
  std::string out;
  out.reserve(json.size());
  for (const char c : json) {
    if (c == '<')
      out += "\\u003c";
    else
      out += c;
  }
  return out;
}

// Nothing is loaded from anywhere, whatever a name in the data says.
constexpr char kPolicy[] =
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:; "
    "base-uri 'none'; form-action 'none'";

}  // namespace

FoundBundle FindWebBundle(const std::string& name) {
  WebBundle bundle;
  for (const auto& [ending, content] : {std::pair{".js", &bundle.script}, std::pair{".css", &bundle.style}}) {
    const std::string file = (ShippedFolder("ED3R_WEB", "web", ED3R_WEB_DIR) / (name + ending)).string();
    std::string why;
    if (!TryReadFile(file, kMaxTextBytes, *content, why))
      return {std::nullopt,
              fmt::format(
                  "the interactive page is not made: {} cannot be read ({}); 'scripts/setup --web' makes it",
                  file, why)};
  }
  return {std::move(bundle), ""};
}

std::string SelfContainedPage(const std::string& title, const WebBundle& bundle,
                              const nlohmann::ordered_json& data, const std::string& plain) {
  std::string page = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"{}\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<link rel=\"icon\" href=\"data:,\">\n<title>{}</title>\n<style>",
      kPolicy, HtmlText(title));
  page += bundle.style;
  page += "</style>\n</head>\n<body>\n<div id=\"app\"></div>\n<noscript>";
  page += plain;
  page += "</noscript>\n<script type=\"application/json\" id=\"page-data\">";
  page += ScriptSafe(JsonText(data, -1));
  page += "</script>\n<script>";
  page += bundle.script;
  return page + "</script>\n</body>\n</html>\n";
}

}  // namespace ed3r::report
