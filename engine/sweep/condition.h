// `where`: which combinations of a sweep are flown. A condition compares parameters with values,
//
//   mission.strategy != rbs or (agents.eta_min >= 0.75 and not mission.sites == known)
//
// in which `not` binds tighter than `and`, and `and` tighter than `or`; == and != compare anything of the
// same type, < <= > >= only numbers. Each side is a parameter's key, a number, a word, or text in quotes; at
// least one is a parameter. A value must be one that the parameter may have. Numbers are compared exactly, as
// the doubles that they read to; files by what they are, however each is called.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/config/config.h"
#include "engine/sweep/setting.h"

namespace ed3r::sweep {

class Condition {
 public:
  // Throws UserError for a misspelt key or value, an order of things that have none, and bad syntax; it names
  // the character of the text. Values are read as settings are, through `reader`.
  static Condition Parse(const YamlNode& node, const SettingReader& reader);

  // Whether the combination that has these parameters is kept.
  bool Holds(const Config& config) const;

  const std::string& At() const { return at_; }

  struct Expression;

 private:
  std::shared_ptr<const Expression> root_;
  std::string at_;
};

// The conditions of a `where`: one text or a list of them, all of which must hold.
std::vector<Condition> ReadConditions(const YamlNode& where, const SettingReader& reader);

}  // namespace ed3r::sweep
