#include "engine/python/argument_words.h"

#include <regex>
#include <utility>

namespace ed3r::python {
namespace {

std::string Reworded(std::string text) {
  static const std::pair<std::regex, const char*> kWords[] = {
      {std::regex(", or --accept-mixed [^;:]*"), ""},
      {std::regex("--set "), "settings: "},
      {std::regex("--missions [^ =]+=([0-9]+)"), "missions=$1"},
      {std::regex("--(missions|out|seed|threads|cache)\\b"), "$1"},
  };
  for (const auto& [word, argument] : kWords) text = std::regex_replace(text, word, argument);
  return text;
}

}  // namespace

std::string InPythonWords(const std::string& message) {
  static const std::regex kCommand("'ed3r [^']*'");
  std::string reworded;
  auto plain = message.cbegin();
  for (auto at = std::sregex_iterator(message.begin(), message.end(), kCommand); at != std::sregex_iterator();
       ++at) {
    reworded += Reworded({plain, (*at)[0].first}) + at->str();
    plain = (*at)[0].second;
  }
  return reworded + Reworded({plain, message.cend()});
}

}  // namespace ed3r::python
