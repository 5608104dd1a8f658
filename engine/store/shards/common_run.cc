#include "engine/store/shards/common_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "engine/core/check.h"
#include "engine/store/part_of_run.h"

namespace ed3r::store {
namespace {

// What is merged is given checksums, as if it had been compared with some.
void CheckHasChecksums(const ResultReader& store) {
  if (!store.Tables().checked())
    throw UserError(fmt::format("{}: {}: it can be read, but not merged; fly it again into another --out",
                                store.dir(), kNothingToCompare));
  const std::vector<RunLayout::Stage>& stages = store.Layout().stages;
  for (std::size_t s = 0; s < stages.size(); ++s)
    if (!store.Tables().complete() &&
        store.Tables().KeptOf(static_cast<int>(s)) != sweep::KeptTimesteps::kAll)
      throw UserError(
          fmt::format("{}: written by an older ed3r without the timesteps of stage {}, of which their new "
                      "checksums would be made: it can be read, but not merged",
                      store.dir(), stages[s].name));
}

}  // namespace

CommonRun::CommonRun(const std::vector<std::string>& dirs, OtherCode other_code) {
  for (const std::string& dir : dirs) Add(dir);
  if (!all_same_) CheckPlans();
  if (other_code == OtherCode::kRefuse) CheckCode();
}

void CommonRun::Add(const std::string& dir) {
  auto reader = std::make_unique<ResultReader>(dir);
  CheckHasChecksums(*reader);
  const Recipe& recipe = reader->StoredRecipe();
  Join(code_, recipe.code);
  parts_.push_back({dir, recipe.plan_text, recipe.code});
  PartPlan plan = PartPlan::kSame;
  if (latest_) plan = ComparePlans(latest_->StoredRecipe(), latest_->Layout(), *reader).plan;
  all_same_ = all_same_ && plan == PartPlan::kSame;
  if (!latest_ || plan == PartPlan::kGrown) latest_ = std::move(reader);
}

void CommonRun::CheckPlans() const {
  for (const Part& part : parts_) {
    ResultReader reader(part.dir);
    const PartOfRun found = ComparePlans(latest_->StoredRecipe(), latest_->Layout(), reader);
    if (!found.Counts()) Refuse(part.dir, found.what);
  }
}

// Where one of them was continued with all the code, that was accepted there.
void CommonRun::CheckCode() const {
  if (std::any_of(parts_.begin(), parts_.end(),
                  [&](const Part& part) { return !CodeDifference(part.code, code_); }))
    return;
  const CodeIdentities& there = latest_->StoredRecipe().code;
  for (const Part& part : parts_)
    for (const auto& difference : {CodeDifference(there, part.code), CodeDifference(part.code, there)})
      if (difference) Refuse(part.dir, *difference + "; --accept-mixed merges them, and the report says so");
}

void CommonRun::Refuse(const std::string& dir, const std::string& why) const {
  throw UserError(fmt::format("{} (there) and {} (here) cannot be merged: {}", latest_->dir(), dir, why));
}

Recipe CommonRun::TheRecipe() const {
  Recipe recipe = latest_->StoredRecipe();
  recipe.files = latest_->Files();
  recipe.code = code_;
  return recipe;
}

std::vector<std::vector<std::string>> CommonRun::ByPlan() const {
  std::vector<std::pair<const std::string*, std::vector<std::string>>> plans;
  for (const Part& part : parts_) {
    auto found =
        std::find_if(plans.begin(), plans.end(), [&](const auto& p) { return *p.first == part.plan_text; });
    if (found == plans.end()) found = plans.insert(plans.end(), {&part.plan_text, {}});
    found->second.push_back(part.dir);
  }
  std::vector<std::vector<std::string>> groups;
  for (auto& [plan, group] : plans) groups.push_back(std::move(group));
  return groups;
}

}  // namespace ed3r::store
