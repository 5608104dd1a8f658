// The run that several stores are parts of: all were flown from one plan, or from plans that it has grown from.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/store/layout.h"
#include "engine/store/reader.h"
#include "engine/store/recipe.h"

namespace ed3r::store {

class CommonRun {
 public:
  // `dirs`: one or more. UserError when two of them are of different runs, or have no checksums; and, unless it is accepted,
  // when they were flown by different code and none of them was continued with all of it. Compares no missions.
  CommonRun(const std::vector<std::string>& dirs, OtherCode other_code);

  // Of the plan that has grown most, with the code of all.
  Recipe TheRecipe() const;
  const RunLayout& Layout() const { return latest_->Layout(); }
  // Those of one plan together.
  std::vector<std::vector<std::string>> ByPlan() const;

 private:
  struct Part {
    std::string dir, plan_text;
    CodeIdentities code;
  };

  void Add(const std::string& dir);
  void CheckPlans() const;
  void CheckCode() const;
  [[noreturn]] void Refuse(const std::string& dir, const std::string& why) const;

  std::unique_ptr<ResultReader> latest_;
  std::vector<Part> parts_;
  CodeIdentities code_;
  bool all_same_ = true;  // as the first
};

}  // namespace ed3r::store
