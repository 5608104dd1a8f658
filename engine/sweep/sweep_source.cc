#include "engine/sweep/sweep_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <system_error>

#include "engine/core/suggest.h"
#include "engine/sweep/sweep_file.h"

namespace ed3r::sweep {
namespace {

Precision ReadPrecision(const YamlNode& node, const ValueCheck& check) {
  ExpectKeys(node, "precision", {"metric", "half_width", "every"});
  const YamlNode* metric = Find(node, "metric");
  const YamlNode* half_width = Find(node, "half_width");
  if (metric == nullptr || half_width == nullptr)
    FailAt(node.at, "precision: needs metric and half_width, e.g. {metric: msr_pct, half_width: 1.5}");
  Precision precision;
  precision.metric = TextOf(*metric, "metric");
  if (const std::string problem = check ? check("precision.metric", precision.metric) : ""; !problem.empty())
    FailAt(metric->at, problem);
  precision.half_width = PositiveNumberOf(*half_width, "half_width");
  if (const YamlNode* every = Find(node, "every"))
    precision.every = static_cast<int>(WholeNumberOf(*every, "every", 2, kMaxMissions));
  return precision;
}

WrittenTimesteps ReadStoreKeys(const YamlNode& node) {
  ExpectKeys(node, "store", {"timesteps"});
  const YamlNode* timesteps = Find(node, "timesteps");
  if (timesteps == nullptr) FailAt(node.at, "store: needs timesteps, e.g. {timesteps: none}");
  const std::string& word = TextOf(*timesteps, "store.timesteps");
  const std::optional<KeptTimesteps> kept = KeptTimestepsOf(word);
  if (!kept)
    FailAt(timesteps->at,
           fmt::format("store.timesteps: '{}' is not allowed; allowed: all | failed | none", word));
  return {*kept, timesteps->at};
}

SweepSection ReadSection(const YamlNode& map, const SettingReader& reader, const ValueCheck& check) {
  SweepSection section;
  if (const YamlNode* missions = Find(map, "missions"))
    section.missions = {static_cast<int>(WholeNumberOf(*missions, "missions", 1, kMaxMissions)),
                        missions->at};
  if (const YamlNode* precision = Find(map, "precision"))
    section.precision = ReadPrecision(*precision, check);
  if (const YamlNode* store = Find(map, "store")) section.timesteps = ReadStoreKeys(*store);
  if (const YamlNode* set = Find(map, "set")) section.set = reader.ReadMap(*set, "set");
  if (const YamlNode* sweep = Find(map, "sweep")) section.axes = ReadAxes(*sweep, reader);
  if (const YamlNode* where = Find(map, "where")) section.where = ReadConditions(*where, reader);
  return section;
}

StageKind ReadKind(const YamlNode& kind) {
  const std::string& text = TextOf(kind, "kind");
  if (text == "fly") return StageKind::kFly;
  if (text == "train") return StageKind::kTrain;
  FailAt(kind.at, fmt::format("kind: '{}' is not allowed; allowed: fly | train", text));
}

void AppendAfter(const YamlNode& node, const std::vector<std::string>& earlier,
                 std::vector<std::string>& after) {
  const std::string& name = TextOf(node, "after");
  if (std::find(earlier.begin(), earlier.end(), name) == earlier.end()) {
    const std::string nearest = NearestWord(name, earlier);
    FailAt(node.at, fmt::format("after: '{}' is not allowed; allowed: stages that stand above ({}){}", name,
                                earlier.empty() ? "none" : Joined(earlier),
                                nearest.empty() ? "" : fmt::format("; did you mean {}?", nearest)));
  }
  if (std::find(after.begin(), after.end(), name) != after.end())
    FailAt(node.at, fmt::format("after: '{}' stands here twice", name));
  after.push_back(name);
}

// Networks learn with the parameters of the arms that ask them: what a training stage said of its own would be lost.
void CheckTrainingSaysNothing(const StageSource& stage) {
  if (stage.kind != StageKind::kTrain) return;
  const auto refuse = [&](const std::string& at, const char* what) {
    FailAt(at, fmt::format("{}: is not allowed in stage '{}' of kind train: networks learn with the "
                           "parameters of the arms that "
                           "ask them; write it in the stage that comes after, or at the top",
                           what, stage.name));
  };
  if (!stage.section.set.empty()) refuse(stage.section.set.front().at, "set");
  if (stage.section.axes && !stage.section.axes->empty()) refuse(stage.section.axes->front().at, "sweep");
  if (stage.section.where && !stage.section.where->empty())
    refuse(stage.section.where->front().At(), "where");
}

StageSource ReadStage(const YamlNode& node, const std::vector<std::string>& earlier,
                      const SettingReader& reader, const ValueCheck& check) {
  ExpectKeys(node, "a stage",
             {"name", "kind", "after", "missions", "precision", "store", "set", "sweep", "where"});
  StageSource stage;
  stage.at = node.at;
  const YamlNode* name = Find(node, "name");
  if (name == nullptr) FailAt(node.at, "name: is missing; every stage has one");
  stage.name = NameOfThing(*name, "name");
  if (std::find(earlier.begin(), earlier.end(), stage.name) != earlier.end())
    FailAt(name->at, fmt::format("name: stage '{}' stands above already", stage.name));
  if (const YamlNode* kind = Find(node, "kind")) stage.kind = ReadKind(*kind);
  if (const YamlNode* after = Find(node, "after")) {
    if (after->kind == YamlNode::Kind::kList) {
      for (const YamlNode& item : after->items) AppendAfter(item, earlier, stage.after);
    } else {
      AppendAfter(*after, earlier, stage.after);
    }
  }
  stage.section = ReadSection(node, reader, check);
  if (stage.kind == StageKind::kTrain && stage.section.missions)
    FailAt(stage.section.missions->at, "missions: is not allowed in a stage of kind train, which flies none");
  if (stage.kind == StageKind::kTrain && stage.section.precision)
    FailAt(stage.at, "precision: is not allowed in a stage of kind train, which flies none");
  if (stage.kind == StageKind::kTrain && stage.section.timesteps)
    FailAt(stage.section.timesteps->at, "store: is not allowed in a stage of kind train, which flies none");
  CheckTrainingSaysNothing(stage);
  return stage;
}

const std::string& AirframeAt(const std::vector<Setting>& settings) {
  return std::find_if(settings.begin(), settings.end(),
                      [](const Setting& setting) { return !setting.airframe_at.empty(); })
      ->airframe_at;
}

// What a file on top says for all stages and every stage of its base says otherwise would be lost.
void CheckReachesAStage(const SweepSource& source, const std::vector<StageSource>& stages) {
  const auto lost = [&](const auto& says) {
    bool any = false;
    for (const StageSource& stage : stages) {
      if (stage.kind == StageKind::kTrain) continue;
      any = true;
      if (!says(stage)) return false;
    }
    return any;
  };
  const auto refuse = [&](const std::string& at, const std::string& what, const std::string& instead) {
    FailAt(at, fmt::format("{}: has no effect: every stage of the base file says its own, at {} first; write "
                           "the stages anew, or "
                           "give {}",
                           what, stages.front().at, instead));
  };
  for (const Setting& setting : source.top.set)
    if (!setting.is_default && lost([&](const StageSource& stage) {
          return std::any_of(stage.section.set.begin(), stage.section.set.end(),
                             [&](const Setting& own) { return own.key == setting.key; });
        }))
      refuse(setting.at, setting.key, fmt::format("--set {}={}", setting.key, setting.canonical));
  if (NameAnAirframe(source.top.set) &&
      lost([](const StageSource& stage) { return NameAnAirframe(stage.section.set); }))
    refuse(AirframeAt(source.top.set), "robot", "--set robot=FILE");
  if (source.top.missions &&
      lost([](const StageSource& stage) { return stage.section.missions.has_value(); }))
    refuse(source.top.missions->at, "missions", "--missions");
  if (source.top.precision &&
      lost([](const StageSource& stage) { return stage.section.precision.has_value(); }))
    refuse(stages.front().at, "precision", "them a precision");
  if (source.top.timesteps &&
      lost([](const StageSource& stage) { return stage.section.timesteps.has_value(); }))
    refuse(source.top.timesteps->at, "store", "them a store");
}

std::vector<StageSource> ReadStages(const YamlNode& node, const SettingReader& reader,
                                    const ValueCheck& check) {
  if (node.kind != YamlNode::Kind::kList || node.items.empty())
    FailAt(node.at, fmt::format("stages: {} is not allowed; allowed: a list of stages",
                                node.kind == YamlNode::Kind::kList ? "an empty list" : Described(node)));
  std::vector<StageSource> stages;
  std::vector<std::string> names;
  for (const YamlNode& item : node.items) {
    stages.push_back(ReadStage(item, names, reader, check));
    names.push_back(stages.back().name);
  }
  return stages;
}

void MergeUnder(SweepSource& source, SweepSource base) {
  SweepSection& top = source.top;
  if (!source.stages && base.stages) CheckReachesAStage(source, *base.stages);
  // A base file's setting is a default, so an axis may vary it; within one file that is a contradiction.
  if (top.axes) base.top.set = DefaultsOf(std::move(base.top.set), *top.axes);
  top.set = MergedSettings(base.top.set, top.set);
  if (!top.missions) top.missions = std::move(base.top.missions);
  if (!top.precision) top.precision = std::move(base.top.precision);
  if (!top.timesteps) top.timesteps = std::move(base.top.timesteps);
  if (!top.axes) top.axes = std::move(base.top.axes);
  if (!top.where) top.where = std::move(base.top.where);
  if (!source.seed) source.seed = base.seed;
  if (!source.stages) source.stages = std::move(base.stages);
}

class SourceReader {
 public:
  SourceReader(const std::string& top_file, const ValueCheck& check)
      : top_folder_(FolderOf(top_file)), check_(check) {}

  SweepSource Read(const std::string& file, bool keep_absolute) {
    const YamlFile yaml = ReadYamlFile(file);
    if (yaml.root.kind == YamlNode::Kind::kNull)
      FailAt(yaml.root.at, "the file is empty; a sweep has at least a name and missions");
    ExpectKeys(yaml.root, "a sweep file",
               {"name", "base", "missions", "precision", "store", "seed", "set", "sweep", "where", "stages"});
    const SettingReader reader(FolderOf(file), top_folder_, keep_absolute, check_);
    SweepSource source;
    source.file = file;
    source.at = yaml.root.at;
    source.question = yaml.first_comment;
    if (const YamlNode* name = Find(yaml.root, "name")) source.name = NameOfThing(*name, "name");
    if (const YamlNode* seed = Find(yaml.root, "seed"))
      source.seed = WholeNumberOf(*seed, "seed", 0, std::numeric_limits<std::uint64_t>::max());
    source.top = ReadSection(yaml.root, reader, check_);
    if (const YamlNode* stages = Find(yaml.root, "stages"))
      source.stages = ReadStages(*stages, reader, check_);
    opened_.push_back(file);
    if (const YamlNode* base = Find(yaml.root, "base"))
      MergeUnder(source, ReadBase(*base, file, keep_absolute));
    return source;
  }

 private:
  static constexpr std::size_t kMaxBases = 20;

  SweepSource ReadBase(const YamlNode& base, const std::string& file, bool keep_absolute) {
    const std::filesystem::path written(TextOf(base, "base"));
    const std::string path = (std::filesystem::path(FolderOf(file)) / written).lexically_normal().string();
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error))
      FailAt(base.at, fmt::format("base: '{}' is not a file; looked for '{}'", written.string(), path));
    if (opened_.size() == kMaxBases)
      FailAt(base.at, fmt::format("base: '{}' is one file too many; allowed: a chain of at most {}",
                                  written.string(), kMaxBases));
    for (const std::string& opened : opened_) {
      if (std::filesystem::equivalent(opened, path, error))
        FailAt(base.at, fmt::format("base: '{}' leads back to {}", written.string(), opened));
    }
    return Read(path, keep_absolute || written.is_absolute());
  }

  std::string top_folder_;
  const ValueCheck& check_;
  std::vector<std::string> opened_;
};

}  // namespace

SweepSource ReadSweepSource(const std::string& file, const ValueCheck& check) {
  return SourceReader(file, check).Read(file, false);
}

std::vector<Setting> MergedSettings(const std::vector<Setting>& under, const std::vector<Setting>& over) {
  std::vector<Setting> merged;
  for (const Setting& setting : NameAnAirframe(over) ? WithoutAirframe(under) : under) {
    const bool replaced =
        std::any_of(over.begin(), over.end(), [&](const Setting& s) { return s.key == setting.key; });
    if (!replaced) merged.push_back(setting);
  }
  merged.insert(merged.end(), over.begin(), over.end());
  return merged;
}

std::vector<Setting> DefaultsOf(std::vector<Setting> settings, const std::vector<Axis>& axes) {
  for (Setting& setting : settings)
    if (FindOnAxes(axes, setting.key) != nullptr) setting.is_default = true;
  return settings;
}

}  // namespace ed3r::sweep
