// What the user reads for each kind of mistake: the files of tests/data/sweep and the whole line for each.
#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "tests/sweep/scratch.h"

namespace ed3r::sweep {
namespace {

struct Broken {
  const char* file;
  const char* message;
};

constexpr Broken kBroken[] = {
    {"airframe_axis.yaml",
     "airframe_axis.yaml:4:3: robot: is no axis: an airframe file sets many parameters; allowed: points of a "
     "list (list: "
     "[{name: mine, robot: FILE}, ...]), or one of its parameters (robot.mass_kg: [1.4, 1.8])"},
    {"axis_value_is_map.yaml",
     "axis_value_is_map.yaml:4:26: agents.eta_min: a map is not allowed; allowed: one value"},
    {"axis_value_out_of_range.yaml",
     "axis_value_out_of_range.yaml:4:26: agents.eta_min: '75' is not allowed; allowed: 0.05 .. 1"},
    {"base_broken.yaml",
     "out_of_range.yaml:4:18: robot.mass_kg: '-1' is not allowed; allowed: 0.05 .. 50 kg"},
    {"base_cycle.yaml", "base_cycle_2.yaml:1:7: base: 'base_cycle.yaml' leads back to base_cycle.yaml"},
    {"base_cycle_2.yaml", "base_cycle.yaml:2:7: base: 'base_cycle_2.yaml' leads back to base_cycle_2.yaml"},
    {"base_missing.yaml",
     "base_missing.yaml:2:7: base: 'nowhere.yaml' is not a file; looked for 'nowhere.yaml'"},
    {"duplicate_alias.yaml",
     "duplicate_alias.yaml:6:5: mission.strategy: duplicate key; it stands first at "
     "duplicate_alias.yaml:5:16"},
    {"duplicate_key.yaml",
     "duplicate_key.yaml:4:1: missions: duplicate key; it stands first at duplicate_key.yaml:2:1"},
    {"duplicate_parameter.yaml",
     "duplicate_parameter.yaml:5:20: robot.mass_kg: duplicate key; it stands first at "
     "duplicate_parameter.yaml:4:18"},
    {"empty_axis.yaml",
     "empty_axis.yaml:4:19: agents.eta_min: an empty axis is not allowed; allowed: at least one value"},
    {"list_bad_name.yaml",
     "list_bad_name.yaml:5:14: name: 'a,b' is not allowed; allowed: at most 64 letters, digits and . _ - +, "
     "the first a letter or digit"},
    {"list_in_set.yaml",
     "list_in_set.yaml:4:19: agents.eta_min: a list is not allowed here; allowed: one value (several make an "
     "axis, under sweep)"},
    {"list_is_empty.yaml",
     "list_is_empty.yaml:4:9: list: an empty list is not allowed; allowed: a list of points {name: ..., KEY: "
     "VALUE, ...}"},
    {"missions_leading_zero.yaml",
     "missions_leading_zero.yaml:2:11: missions: '010' is not allowed; allowed: 1 .. 10000000"},
    {"missions_missing.yaml",
     "missions_missing.yaml:2:1: missions: is missing in stage 'online'; allowed: 1 .. 10000000"},
    {"missions_not_whole.yaml",
     "missions_not_whole.yaml:2:11: missions: '8.5' is not allowed; allowed: 1 .. 10000000"},
    {"missions_too_many.yaml",
     "missions_too_many.yaml:2:11: missions: '10000001' is not allowed; allowed: 1 .. 10000000"},
    {"name_empty.yaml", "name_empty.yaml:1:1: name: nothing is not allowed; allowed: one value"},
    {"name_is_path.yaml",
     "name_is_path.yaml:1:7: name: '../x' is not allowed; allowed: at most 64 letters, digits and . _ - +, "
     "the first a letter or digit"},
    {"name_missing.yaml", "name_missing.yaml:1:1: name: is missing; a sweep's name is that of its results"},
    {"not_a_choice.yaml",
     "not_a_choice.yaml:3:22: mission.sites: 'knwon' is not allowed; allowed: all | known"},
    {"out_of_range.yaml",
     "out_of_range.yaml:4:18: robot.mass_kg: '-1' is not allowed; allowed: 0.05 .. 50 kg"},
    {"physics_only.yaml",
     "physics_only.yaml:3:25: cpu.frequency_hz: is a value of 'ed3r physics' only; in a mission it is drawn "
     "per timestep"},
    {"range_backwards.yaml",
     "range_backwards.yaml:4:27: agents.eta_min: step '0.1' does not lead from 0.9 to 0.5; allowed: range: "
     "[first, last, step], three numbers"},
    {"range_leaves_limits.yaml",
     "range_leaves_limits.yaml:4:27: agents.eta_min: '1.2' is not allowed; allowed: 0.05 .. 1"},
    {"range_of_two.yaml",
     "range_of_two.yaml:4:27: agents.eta_min: a range of 2 values is not allowed; allowed: range: [first, "
     "last, step], three numbers"},
    {"range_of_words.yaml",
     "range_of_words.yaml:4:27: agents.eta_min: 'low' is not a number; allowed: range: [first, last, step], "
     "three numbers"},
    {"range_too_fine.yaml",
     "range_too_fine.yaml:4:27: agents.eta_min: a range of 800000001 values is not allowed; allowed: at most "
     "10000"},
    {"rule_between_parameters.yaml",
     "rule_between_parameters.yaml:4:32: agents.eta_int: '0.2' is not allowed; at most agents.eta_min = 0.1 "
     "(arm 'ed3r-10')"},
    {"rule_between_settings.yaml",
     "rule_between_settings.yaml:4:24: radio.power_min_dbm: '30' is not allowed; at most radio.power_max_dbm "
     "= 20 (arm 'rbs')"},
    {"same_name_twice.yaml",
     "same_name_twice.yaml:6:7: two arms of stage 'online' have the name 'light', the first at "
     "same_name_twice.yaml:5:7; a list can name them"},
    {"same_value_twice.yaml",
     "same_value_twice.yaml:4:26: two arms of stage 'online' have the name 'rbs,eta_min=0.75', the first at "
     "same_value_twice.yaml:4:20; a list can name them"},
    {"seed_negative.yaml",
     "seed_negative.yaml:3:7: seed: '-1' is not allowed; allowed: 0 .. 18446744073709551615"},
    {"seed_too_large.yaml",
     "seed_too_large.yaml:3:7: seed: '18446744073709551616' is not allowed; allowed: 0 .. "
     "18446744073709551615"},
    {"set_and_axis.yaml",
     "set_and_axis.yaml:3:23: agents.eta_min: '0.75' is not allowed here: the sweep varies it, at "
     "set_and_axis.yaml:4:26"},
    {"set_over_base_axis.yaml",
     "set_over_base_axis.yaml:3:23: agents.eta_min: '0.75' is not allowed here: the sweep varies it, at "
     "good.yaml:8:20"},
    {"stage_after_itself.yaml",
     "stage_after_itself.yaml:4:28: after: 'online' is not allowed; allowed: stages that stand above (none)"},
    {"stage_after_unknown.yaml",
     "stage_after_unknown.yaml:5:27: after: 'warmpu' is not allowed; allowed: stages that stand above "
     "(warmup); did you mean warmup?"},
    {"stage_kind.yaml", "stage_kind.yaml:4:28: kind: 'trian' is not allowed; allowed: fly | train"},
    {"stage_train_missions.yaml",
     "stage_train_missions.yaml:3:45: missions: is not allowed in a stage of kind train, which flies none"},
    {"stage_twice.yaml", "stage_twice.yaml:5:12: name: stage 'warmup' stands above already"},
    {"stage_unknown_key.yaml", "stage_unknown_key.yaml:4:20: afer: unknown key; did you mean after?"},
    {"stage_without_name.yaml", "stage_without_name.yaml:4:5: name: is missing; every stage has one"},
    {"stages_empty.yaml",
     "stages_empty.yaml:3:9: stages: an empty list is not allowed; allowed: a list of stages"},
    {"too_many_arms.yaml",
     "too_many_arms.yaml:4:3: more than 9223372036854775807 combinations in stage 'online' are not allowed; "
     "allowed: at most 10000 arms in a sweep"},
    {"too_many_missions.yaml",
     "too_many_missions.yaml:2:11: 12000000 missions in the stages up to 'online' are not allowed; allowed: "
     "at most 10000000 in a sweep"},
    {"two_axes_of_one_key.yaml",
     "two_axes_of_one_key.yaml:6:36: robot.mass_kg: is on another axis, too, at "
     "two_axes_of_one_key.yaml:4:19"},
    {"unknown_axis.yaml", "unknown_axis.yaml:4:3: agents.eta_mim: unknown key; did you mean agents.eta_min?"},
    {"unknown_axis_form.yaml", "unknown_axis_form.yaml:4:20: rang: unknown key; did you mean range?"},
    {"unknown_key.yaml", "unknown_key.yaml:2:1: mision: unknown key; did you mean missions?"},
    {"unknown_key_far.yaml",
     "unknown_key_far.yaml:3:1: colour: unknown key; a sweep file has name, base, missions, precision, "
     "store, seed, "
     "set, "
     "sweep, where, stages"},
    {"unknown_parameter.yaml",
     "unknown_parameter.yaml:4:3: robot.mas_kg: unknown key; did you mean robot.mass_kg?"},
    {"unknown_parameter_nested.yaml",
     "unknown_parameter_nested.yaml:6:5: robot.sped_mps: unknown key; did you mean robot.speed_mps?"},
    {"value_in_sweep.yaml",
     "value_in_sweep.yaml:4:19: agents.eta_min: '0.65' is not an axis; allowed: a list of values or {range: "
     "[first, last, step]} (a fixed value belongs under set)"},
    {"where_is_map.yaml",
     "where_is_map.yaml:3:8: where: a map is not allowed; allowed: a condition or a list of them"},
    {"where_keeps_nothing.yaml",
     "where_keeps_nothing.yaml:4:8: where: none of the 2 combinations of stage 'online' is kept; allowed: at "
     "least one"},
    {"where_open.yaml",
     "where_open.yaml:3:8: where: its end is not allowed at character 40 of the condition; allowed: 'and', "
     "'or' or ')'"},
    {"where_order.yaml",
     "where_order.yaml:3:8: where: '<' is not allowed for mission.strategy, which is no number; allowed: == "
     "!="},
    {"where_syntax.yaml",
     "where_syntax.yaml:4:28: where: '=' is not allowed at character 10 of the condition; allowed: == != < "
     "<= > >="},
    {"where_types.yaml",
     "where_types.yaml:3:8: where: mission.strategy and robot.mass_kg cannot be compared: one is a number"},
    {"where_unknown.yaml",
     "where_unknown.yaml:4:8: where: neither 'mision.strategy' nor 'rbs' is a parameter of a mission; did "
     "you mean mission.strategy?"},
    {"where_value.yaml", "where_value.yaml:3:8: mission.sites: 'knwon' is not allowed; allowed: all | known"},
    {"world_missing.yaml",
     "world_missing.yaml:3:22: mission.world: 'worlds/nowhere.yaml' is not a file; looked for "
     "'worlds/nowhere.yaml'"},
    {"wrong_type.yaml", "wrong_type.yaml:3:25: robot.propellers: 'four' is not allowed; allowed: 3 .. 16"},
    {"yaml_alias.yaml", "yaml_alias.yaml:2:6: not valid YAML: the referenced anchor is not defined"},
    {"yaml_anchor.yaml", "yaml_anchor.yaml:2:6: anchors and aliases are not allowed; write the value out"},
    {"yaml_key_is_list.yaml", "yaml_key_is_list.yaml:2:3: a list is not allowed as a key; allowed: a word"},
    {"yaml_lines.yaml",
     "yaml_lines.yaml:3:8: a value of several lines or with control characters is not allowed"},
    {"yaml_list_at_top.yaml",
     "yaml_list_at_top.yaml:1:1: a sweep file: a list is not allowed; allowed: a map with the keys name, "
     "base, missions, precision, store, seed, set, sweep, where, stages"},
    {"yaml_syntax.yaml", "yaml_syntax.yaml:3:9: not valid YAML: end of sequence flow not found"},
    {"yaml_tab.yaml", "yaml_tab.yaml:3:1: a tab is not allowed; indent with spaces"},
    {"yaml_tag.yaml", "yaml_tag.yaml:2:11: tag 'tag:yaml.org,2002:int' is not allowed"},
    {"yaml_two_documents.yaml",
     "yaml_two_documents.yaml:3:1: a second document is not allowed; a file holds one"},
    {"zip_is_list.yaml",
     "zip_is_list.yaml:4:8: zip: a list is not allowed; allowed: a map of parameters, each with a list of as "
     "many values"},
    {"zip_lengths.yaml",
     "zip_lengths.yaml:6:24: zip: robot.battery_mah has 3 values and robot.mass_kg has 2; allowed: as many "
     "of each"},
};

const std::string kFolder = ED3R_SOURCE_DIR "/tests/data/sweep/";

std::string MessageOf(const std::string& file) {
  try {
    LoadSweep(kFolder + file);
  } catch (const UserError& error) {
    std::string message = error.what();
    for (std::size_t at; (at = message.find(kFolder)) != std::string::npos;)
      message.erase(at, kFolder.size());
    return message;
  }
  return "accepted";
}

TEST(BrokenSweepsTest, EachIsRefusedWithItsLine) {
  for (const Broken& broken : kBroken) EXPECT_EQ(MessageOf(broken.file), broken.message);
}

TEST(BrokenSweepsTest, TheTableIsComplete) {
  std::set<std::string> listed = {"good.yaml"};  // the base of some of them
  for (const Broken& broken : kBroken) listed.insert(broken.file);
  std::set<std::string> present;
  for (const auto& entry : std::filesystem::directory_iterator(kFolder))
    present.insert(entry.path().filename().string());
  EXPECT_EQ(listed, present);
  EXPECT_EQ(MessageOf("good.yaml"), "accepted");
}

}  // namespace
}  // namespace ed3r::sweep
