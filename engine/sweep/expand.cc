#include "engine/sweep/expand.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <map>
#include <set>

#include "engine/config/parameters.h"
#include "engine/core/check.h"
#include "engine/core/files/shipped.h"
#include "engine/sweep/arm_id.h"
#include "engine/sweep/arm_name.h"
#include "engine/sweep/sweep_file.h"

namespace ed3r::sweep {
namespace {

void Apply(const Setting& setting, Arm& arm) {
  const std::string problem = SetParameter(arm.config, setting.key, setting.text);
  ED3R_CHECK(problem.empty(), problem);  // checked when it was read
  if (NamesAFile(setting.key)) arm.files[setting.key] = setting.canonical;
}

// The world of a sweep that names none: beside the sweep file, as in the shipped folder, or else that folder's own.
std::string DefaultWorld(const std::string& folder, const std::string& world) {
  const std::string beside = PathFrom(folder, world);
  std::error_code error;
  if (std::filesystem::exists(beside, error)) return beside;
  const std::filesystem::path shipped = ShippedSweeps() / world;
  return std::filesystem::exists(shipped, error) ? shipped.string() : beside;
}

// Combinations of the axes; the largest number there is when they are even more.
std::int64_t Combinations(const std::vector<Axis>& axes) {
  std::int64_t product = 1;
  for (const Axis& axis : axes) {
    if (__builtin_mul_overflow(product, static_cast<std::int64_t>(axis.points.size()), &product))
      return std::numeric_limits<std::int64_t>::max();
  }
  return product;
}

std::string SizeText(std::int64_t size) {
  return size == std::numeric_limits<std::int64_t>::max() ? fmt::format("more than {}", size)
                                                          : std::to_string(size);
}

// Expands one stage. The first `variant_axes` of its axes are the study's, the others the stage's own.
class StageExpander {
 public:
  StageExpander(Stage& stage, std::string at, std::vector<Axis> axes, std::size_t variant_axes,
                std::vector<Condition> where)
      : stage_(stage),
        at_(std::move(at)),
        axes_(std::move(axes)),
        variant_axes_(static_cast<std::ptrdiff_t>(variant_axes)),
        where_(std::move(where)) {
    CheckAxesDiffer(axes_);
    for (const Axis& axis : axes_)
      for (const AxisPoint& point : axis.points)
        for (const Setting& setting : point.settings) axis_keys_.insert(setting.key);
  }

  const std::string& AxesAt() const { return axes_.empty() ? at_ : axes_[0].at; }
  std::int64_t Size() const { return Combinations(axes_); }

  void Expand(const std::vector<Setting>& written, const std::vector<Setting>& overriding,
              const std::string& top_folder) {
    CheckOffAxes(written, overriding);
    fixed_ = MergedSettings(written, overriding);
    const Arm common = ArmWith(fixed_, top_folder);
    const Arm without_airframe = ArmWith(WithoutAirframe(fixed_), top_folder);
    for (std::int64_t index = 0; index < Size(); ++index) {
      const std::vector<const AxisPoint*> points = PointsAt(index);
      const bool own_airframe = std::any_of(points.begin(), points.end(), [](const AxisPoint* point) {
        return NameAnAirframe(point->settings);
      });
      AddCombination(points, own_airframe ? without_airframe : common);
    }
    if (stage_.arms.empty())
      FailAt(where_.front().At(),
             fmt::format("where: none of the {} combinations of stage '{}' is kept; allowed: at least one",
                         Size(), stage_.name));
  }

 private:
  void CheckOffAxes(const std::vector<Setting>& fixed, const std::vector<Setting>& overrides) const {
    for (const Setting& setting : overrides) {
      if (!setting.airframe_at.empty()) CheckOffAirframes(setting);
      if (setting.is_default) continue;
      if (const Setting* axis = FindOnAxes(axes_, setting.key))
        FailAt(setting.at,
               fmt::format("{}: is not allowed here: the sweep varies it, at {}", setting.key, axis->at));
    }
    for (const Setting& setting : fixed) {
      if (setting.is_default) continue;
      if (const Setting* axis = FindOnAxes(axes_, setting.key))
        FailAt(setting.at, fmt::format("{}: '{}' is not allowed here: the sweep varies it, at {}",
                                       setting.key, setting.canonical, axis->at));
    }
  }

  // Single parameters of an airframe file may be varied; where points name whole files, another one for all would be lost.
  void CheckOffAirframes(const Setting& forced) const {
    for (const Axis& axis : axes_)
      for (const AxisPoint& point : axis.points)
        for (const Setting& setting : point.settings)
          if (!setting.airframe_at.empty())
            FailAt(forced.airframe_at,
                   fmt::format("robot: is not allowed here: the sweep varies it, at {}; write the file there",
                               setting.airframe_at));
  }

  // The first axis is the slowest, as nested loops in the order written.
  std::vector<const AxisPoint*> PointsAt(std::int64_t index) const {
    std::vector<const AxisPoint*> points(axes_.size());
    for (std::size_t i = axes_.size(); i-- > 0;) {
      const auto count = static_cast<std::int64_t>(axes_[i].points.size());
      points[i] = &axes_[i].points[static_cast<std::size_t>(index % count)];
      index /= count;
    }
    return points;
  }

  static Arm ArmWith(const std::vector<Setting>& settings, const std::string& top_folder) {
    Arm arm;
    arm.files["mission.world"] = arm.config.mission.world;
    arm.config.mission.world = DefaultWorld(top_folder, arm.config.mission.world);
    for (const Setting& setting : settings) Apply(setting, arm);
    return arm;
  }

  void AddCombination(const std::vector<const AxisPoint*>& points, const Arm& common) {
    Arm arm = common;
    for (const AxisPoint* point : points) {
      for (const Setting& setting : point->settings) {
        Apply(setting, arm);
        arm.settings.emplace_back(setting.key, setting.canonical);
      }
    }
    for (const Condition& condition : where_)
      if (!condition.Holds(arm.config)) return;
    arm.name = ArmName(stage_, arm.config, {points.begin() + variant_axes_, points.end()}, axis_keys_);
    if (variant_axes_ > 0) {
      arm.variant = VariantName({points.begin(), points.begin() + variant_axes_}, axis_keys_);
      arm.name = ArmId{arm.name, arm.variant}.Text();
    }
    if (const std::string problem = CheckParameters(arm.config); !problem.empty())
      FailAt(PlaceOf(problem, points), fmt::format("{} (arm '{}')", problem, arm.name));
    const std::string at = points.empty() ? at_ : points.back()->at;
    const auto [first, is_new] = name_places_.emplace(arm.name, at);
    if (!is_new)
      FailAt(at,
             fmt::format("two arms of stage '{}' have the name '{}', the first at {}; a list can name them",
                         stage_.name, arm.name, first->second));
    stage_.arms.push_back(std::move(arm));
  }

  // Where to look for a rule between parameters that is broken: the setting of the parameter that it blames,
  // else (that one has its default) of another one that it names.
  std::string PlaceOf(const std::string& problem, const std::vector<const AxisPoint*>& points) const {
    std::vector<const Setting*> settings;
    for (const AxisPoint* point : points)
      for (const Setting& setting : point->settings) settings.push_back(&setting);
    for (const Setting& setting : fixed_) settings.push_back(&setting);
    for (const Setting* setting : settings)
      if (problem.starts_with(setting->key + ":")) return setting->at;
    for (const Setting* setting : settings)
      if (problem.find(" " + setting->key + " ") != std::string::npos) return setting->at;
    return at_;
  }

  Stage& stage_;
  std::string at_;
  std::vector<Axis> axes_;
  std::ptrdiff_t variant_axes_;
  std::set<std::string> axis_keys_;
  std::vector<Condition> where_;
  std::vector<Setting> fixed_;
  std::map<std::string, std::string> name_places_;
};

template <class T>
std::vector<T> Concatenated(const std::optional<std::vector<T>>& a, const std::optional<std::vector<T>>& b) {
  std::vector<T> all = a.value_or(std::vector<T>());
  if (b) all.insert(all.end(), b->begin(), b->end());
  return all;
}

// How many missions each arm of a stage flies, and where that is said.
WrittenCount MissionsOf(const StageSource& stage, const SweepSource& source, const MissionCounts& overrides) {
  if (stage.kind == StageKind::kTrain) return {0, stage.at};
  for (const std::string& name : {stage.name, std::string()})
    if (const auto found = overrides.find(name); found != overrides.end()) return found->second;
  if (stage.section.missions) return *stage.section.missions;
  if (source.top.missions) return *source.top.missions;
  FailAt(stage.at,
         fmt::format("missions: is missing in stage '{}'; allowed: 1 .. {}", stage.name, kMaxMissions));
}

WrittenTimesteps TimestepsOf(const StageSource& stage, const SweepSource& source) {
  if (stage.section.timesteps) return *stage.section.timesteps;
  return source.top.timesteps.value_or(WrittenTimesteps{KeptTimesteps::kAll, stage.at});
}

// Networks learn from timesteps of the stages that a training stage builds on, directly or not.
void CheckLessonsAreKept(const std::vector<Stage>& stages, const std::vector<StageSource>& written,
                         const SweepSource& source) {
  for (const Stage& training : stages) {
    if (training.kind != StageKind::kTrain) continue;
    std::set<std::string> foundations(training.after.begin(), training.after.end());
    for (std::size_t s = stages.size(); s-- > 0;) {
      const Stage& stage = stages[s];
      if (!foundations.contains(stage.name)) continue;
      foundations.insert(stage.after.begin(), stage.after.end());
      if (stage.timesteps != KeptTimesteps::kAll)
        FailAt(TimestepsOf(written[s], source).at,
               fmt::format("store.timesteps: '{}' is not allowed for stage '{}': stage '{}' learns from its "
                           "timesteps; allowed there: all; write it in the stages that nothing learns from",
                           NameOf(stage.timesteps), stage.name, training.name));
    }
  }
}

void CheckStagesOf(const MissionCounts& missions, const std::vector<StageSource>& stages) {
  std::vector<std::string> flying;
  for (const StageSource& stage : stages)
    if (stage.kind == StageKind::kFly) flying.push_back(stage.name);
  for (const auto& [name, count] : missions)
    if (!name.empty() && std::find(flying.begin(), flying.end(), name) == flying.end())
      FailAt(count.at,
             fmt::format("'{}' is not a stage that flies; allowed: {}", name, fmt::join(flying, " | ")));
}

}  // namespace

std::vector<Stage> ExpandStages(const SweepSource& source, const std::vector<Setting>& overrides,
                                const MissionCounts& missions) {
  std::vector<StageSource> written = source.stages.value_or(std::vector<StageSource>());
  if (!source.stages) written.push_back({"online", source.at, StageKind::kFly, {}, {}});
  CheckStagesOf(missions, written);
  std::vector<Stage> stages;
  std::int64_t all_arms = 0;
  std::int64_t all_missions = 0;
  for (const StageSource& from : written) {
    const WrittenCount count = MissionsOf(from, source, missions);
    stages.push_back({from.name, from.kind, from.after, count.value, {}, {}, KeptTimesteps::kAll});
    Stage& stage = stages.back();
    if (stage.kind == StageKind::kFly)
      stage.precision = from.section.precision ? from.section.precision : source.top.precision;
    if (stage.kind == StageKind::kFly) stage.timesteps = TimestepsOf(from, source).kept;
    const std::size_t variant_axes = source.stages && source.top.axes ? source.top.axes->size() : 0;
    StageExpander expander(stage, from.at, Concatenated(source.top.axes, from.section.axes), variant_axes,
                           Concatenated(source.top.where, from.section.where));
    if (expander.Size() > kMaxArms - all_arms)
      FailAt(
          expander.AxesAt(),
          fmt::format("{} combinations in stage '{}'{} are not allowed; allowed: at most {} arms in a sweep",
                      SizeText(expander.Size()), stage.name,
                      all_arms > 0 ? fmt::format(", after {} arms,", all_arms) : "", kMaxArms));
    const std::vector<Setting> under =
        from.section.axes ? DefaultsOf(source.top.set, *from.section.axes) : source.top.set;
    expander.Expand(MergedSettings(under, from.section.set), overrides, FolderOf(source.file));
    all_arms += static_cast<std::int64_t>(stage.arms.size());
    all_missions += static_cast<std::int64_t>(stage.arms.size()) * stage.missions;
    if (all_missions > kMaxMissions)
      FailAt(count.at,
             fmt::format("{} missions in the stages up to '{}' are not allowed; allowed: at most {} "
                         "in a sweep",
                         all_missions, stage.name, kMaxMissions));
  }
  CheckLessonsAreKept(stages, written, source);
  return stages;
}

}  // namespace ed3r::sweep
