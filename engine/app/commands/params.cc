#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "engine/agents/strategy.h"
#include "engine/app/commands.h"
#include "engine/app/words.h"
#include "engine/config/parameters.h"
#include "engine/core/check.h"

namespace ed3r::app {
namespace {

struct Options {
  std::string filter;
  bool json = false;
};

std::string StrategyNames() {
  std::vector<std::string_view> names;
  for (const agents::Strategy& strategy : agents::Strategies()) names.push_back(strategy.name);
  return fmt::format("{}", fmt::join(names, " | "));
}

std::vector<ParameterInfo> Selected(const std::string& filter) {
  std::vector<ParameterInfo> selected;
  for (const ParameterInfo& parameter : Parameters())
    if (parameter.key.find(filter) != std::string::npos) selected.push_back(parameter);
  for (ParameterInfo& parameter :
       selected)  // which the table of parameters, above the strategies, does not know
    if (parameter.key == "mission.strategy") parameter.allowed = StrategyNames();
  if (selected.empty())
    throw UserError(
        fmt::format("params: no key contains '{}'{}", filter, DidYouMean(filter, ParameterKeys())));
  return selected;
}

void PrintJson(const std::vector<ParameterInfo>& parameters) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const ParameterInfo& p : parameters) {
    list.push_back({{"key", p.key},
                    {"unit", p.unit},
                    {"default", p.default_value},
                    {"allowed", p.allowed},
                    {"source", p.source},
                    {"meaning", p.meaning},
                    {"in_sweeps", p.scope == Scope::kMission}});
  }
  fmt::print("{}\n", list.dump(2));
}

constexpr std::size_t kWidestAllowed = 40;  // a longer list pushes its own line only

void PrintTable(const std::vector<ParameterInfo>& parameters) {
  std::size_t key_width = 0, default_width = 0, unit_width = 0, allowed_width = 0;
  for (const ParameterInfo& p : parameters) {
    key_width = std::max(key_width, p.key.size());
    default_width = std::max(default_width, p.default_value.size());
    unit_width = std::max(unit_width, p.unit.size());
    if (p.allowed.size() <= kWidestAllowed) allowed_width = std::max(allowed_width, p.allowed.size());
  }
  std::string subject;
  for (const ParameterInfo& p : parameters) {
    const std::string next = p.key.substr(0, p.key.find('.'));
    if (next != subject) fmt::print("{}{}\n", subject.empty() ? "" : "\n", next);
    subject = next;
    fmt::print("  {:<{}}  {:>{}} {:<{}}  {:<{}}  {} [{}]\n", p.key, key_width, p.default_value, default_width,
               p.unit, unit_width, p.allowed, allowed_width, p.meaning, p.source);
  }
}

}  // namespace

Command AddParams(Program& program) {
  auto options = std::make_shared<Options>();
  CommandLine parser =
      program.AddCommand("params", "Every parameter: key, default, unit, allowed values, meaning, source");
  parser.Option("FILTER", options->filter, "Only keys that contain this text");
  parser.Flag("--json", options->json, "Print JSON");
  return {parser, [options] {
            const std::vector<ParameterInfo> selected = Selected(options->filter);
            options->json ? PrintJson(selected) : PrintTable(selected);
            return kDone;
          }};
}

}  // namespace ed3r::app
