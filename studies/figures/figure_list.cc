#include "studies/figures/figure_list.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <string_view>

#include "studies/paper/arms.h"

namespace ed3r::figures {
namespace {

using Indices = std::vector<std::size_t>;

struct Group {
  std::string id, title, paper;  // paper: where its counterparts are, "" where it has none
  Indices arms;
};

struct PaperGroup {
  const char *id, *title, *paper;
};

// Of the paper's comparisons (paper/arms.h).
constexpr PaperGroup kPaperGroups[] = {
    {"thresholds", "ED³R under three detection thresholds", "Result 1"},
    {"ablations", "ED³R and its four ablations", "Result 2"},
    {"baselines", "ED³R against its baselines", "Result 3, its table as figures"},
};

bool IsWarmup(std::span<const ArmPlan> plans, const metrics::ArmData& arm) {
  const ArmPlan* plan = PlanOf(plans, arm);
  return plan != nullptr && plan->warmup;
}

std::string Strategy(std::span<const ArmPlan> plans, const metrics::ArmData& arm) {
  const ArmPlan* plan = PlanOf(plans, arm);
  return plan == nullptr ? "" : plan->Setting("mission.strategy");
}

// The named arms of the last stage that flew two of them at least.
Indices Together(std::span<const metrics::ArmData> arms, std::span<const std::string_view> names) {
  for (auto last = arms.rbegin(); last != arms.rend(); ++last) {
    Indices found;
    for (const std::string_view name : names)
      for (std::size_t a = 0; a < arms.size(); ++a)
        if (arms[a].stage == last->stage && arms[a].name == name && !arms[a].missions.empty())
          found.push_back(a);
    if (found.size() >= 2) return found;
  }
  return {};
}

// `rest` stage by stage, in groups of kGroupArms at most.
void AddRest(std::span<const metrics::ArmData> arms, const Indices& rest, std::vector<Group>& groups) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < rest.size() && count < kMostGroups; ++count) {
    Group group{fmt::format("arms-{}", count + 1), fmt::format("Stage {}", arms[rest[i]].stage), "", {}};
    const std::string& stage = arms[rest[i]].stage;
    while (i < rest.size() && arms[rest[i]].stage == stage && group.arms.size() < kGroupArms)
      group.arms.push_back(rest[i++]);
    groups.push_back(std::move(group));
  }
}

std::vector<Group> MakeGroups(std::span<const metrics::ArmData> arms, const Indices& drawn) {
  std::vector<Group> groups;
  std::set<std::size_t> held;
  for (const PaperGroup& paper : kPaperGroups) {
    const Indices found = Together(arms, paper::ArmsOfComparison(paper.id));
    if (found.empty()) continue;
    groups.push_back({paper.id, paper.title, paper.paper, found});
    held.insert(found.begin(), found.end());
  }
  Indices rest;
  for (const std::size_t a : drawn)
    if (!held.contains(a)) rest.push_back(a);
  AddRest(arms, rest, groups);
  return groups;
}

// The warm-ups that the networks of the group's arms learnt from: ECD²R has one of its own, RBS needs none.
Indices WarmupsOf(const Indices& group, std::span<const metrics::ArmData> arms,
                  std::span<const ArmPlan> plans) {
  bool own = false, shared = false;
  for (const std::size_t a : group) {
    const std::string strategy = Strategy(plans, arms[a]);
    own = own || strategy == "ecd2r";
    shared = shared || strategy == "ed3r" || strategy.starts_with("ablation");
  }
  Indices warmups;
  for (std::size_t a = 0; a < arms.size(); ++a) {
    if (!IsWarmup(plans, arms[a]) || arms[a].missions.empty()) continue;
    if (std::find(group.begin(), group.end(), a) != group.end()) continue;
    if (Strategy(plans, arms[a]) == "random-offload" ? own : shared) warmups.push_back(a);
  }
  return warmups;
}

std::string Counterpart(const Group& group, const char* which) {
  return group.paper.empty() ? "" : fmt::format(" Counterpart of the paper's {} ({}).", which, group.paper);
}

void AddGroupFigures(const Group& group, std::span<const metrics::ArmData> arms,
                     std::span<const ArmPlan> plans, std::vector<FigureSpec>& figures) {
  figures.push_back(
      {"overview-" + group.id, "overview", group.title + ": performance overview",
       "Every point is a mission, in the order of their numbers from left to right: its energy, its mean "
       "confidence over reliable timesteps, and how well the networks foresaw its rewards. Colour and shape "
       "tell how it ended. A mission without any reliable timestep has no confidence and is only counted, "
       "likewise one without predictions. Lines are means over all missions that have a value, with 95 % "
       "intervals; diamonds are the paper's values." +
           Counterpart(group, "performance overview"),
       group.arms, WarmupsOf(group.arms, arms, plans)});
  figures.push_back(
      {"insights-" + group.id,
       "insights",
       group.title + ": where the energy goes, how missions end",
       "Mean energy of a mission by what it was spent on (movement includes hovering while the robot senses, "
       "computes and transmits), the outcomes of all missions, and the share of energy that went into failed "
       "ones. Whiskers are 95 % intervals; diamonds are the paper's values. Of the outcomes only success has "
       "them, in the lane below each bar." +
           Counterpart(group, "performance insights"),
       group.arms,
       {}});
  figures.push_back(
      {"decisions-" + group.id,
       "decisions",
       group.title + ": decisions of the robot, durations",
       "Where and with which model the timesteps were processed, how long missions take on average, and the "
       "share of missions that have ended by a given time; the dotted line is the 10-minute window. Whiskers "
       "are 95 % intervals; diamonds are the paper's values. Those below the bars mark where parts end, "
       "counted from the left: what was offloaded, and all that the Full model processed." +
           Counterpart(group, "decision-making figure"),
       group.arms,
       {}});
}

void AddRunFigures(std::span<const metrics::ArmData> arms, const Indices& drawn, std::size_t shown_missions,
                   std::vector<FigureSpec>& figures) {
  if (drawn.size() >= 2)
    figures.push_back(
        {"pareto",
         "pareto",
         "Energy against success",
         "Each point is an arm: mean energy of a mission and mission success rate, with 95 % intervals on "
         "both axes. Up and left is better; the dashed line joins the arms whose means no other beats in "
         "both, and is as uncertain as they are. Diamonds are the paper's values, tied to ours by dotted "
         "lines; an arm without one has no success rate in the paper. Counterpart of the paper's Pareto "
         "figure.",
         drawn,
         {}});
  figures.push_back(
      {"sites",
       "sites",
       "Success by fire site",
       "Mission success rate (MSR) at each fire site. The warm-up had seen the sites on the left; those on "
       "the right are new to the networks. The columns at the end pool them, with 95 % intervals, as the "
       "report's table of generalisation does. Under each site: its missions per arm.",
       drawn,
       {}});
  if (shown_missions > 0)
    figures.push_back(
        {"map",
         "map",
         "Missions seen from above",
         "For each outcome the mission of the median duration. Dots are timesteps, coloured by their stable "
         "confidence score; arrows on the path point the way of flight; RC is the base station of the remote "
         "controller. The ground is shaded as if lit from the north-west.",
         {},
         {}});
  Indices long_enough;
  for (const std::size_t a : drawn)
    if (arms[a].missions.size() >= kConvergenceStart) long_enough.push_back(a);
  if (!long_enough.empty())
    figures.push_back({"convergence",
                       "convergence",
                       "How sure after how many missions",
                       "Half the width of the 95 % interval of mean energy and of the success rate, from the "
                       "first n missions of each arm; thin grey lines are the other arms. Dashed: over "
                       "missions alone, which falls as one over the square root of n (the grey band, "
                       "through the typical arm). Solid: with the luck of training, which more missions of "
                       "the same networks do not average out.",
                       long_enough,
                       {}});
}

}  // namespace

FigureSpec VariantFigure(const std::string& first_variant) {
  return {
      "variants",
      "variants",
      "What each variant changes",
      fmt::format(
          "Each variant minus '{}', paired by scenario, with 95 % intervals: mean energy of a mission and "
          "mission success rate. Filled: the interval does not hold 0. Every variant flew its own "
          "warm-up and trained its own networks, so that intervals of arms with networks hold the luck of "
          "training where several flew.",
          first_variant),
      {},
      {}};
}

const ArmPlan* PlanOf(std::span<const ArmPlan> plans, const metrics::ArmData& arm) {
  for (const ArmPlan& plan : plans)
    if (plan.stage == arm.stage && plan.name == arm.name) return &plan;
  return nullptr;
}

std::vector<FigureSpec> ListFigures(std::span<const metrics::ArmData> arms, std::span<const ArmPlan> plans,
                                    std::size_t shown_missions) {
  Indices drawn, flown;
  for (std::size_t a = 0; a < arms.size(); ++a) {
    if (arms[a].missions.empty()) continue;
    flown.push_back(a);
    if (!IsWarmup(plans, arms[a])) drawn.push_back(a);
  }
  if (drawn.empty()) drawn = flown;
  std::vector<FigureSpec> figures;
  if (drawn.empty()) return figures;
  for (const Group& group : MakeGroups(arms, drawn)) AddGroupFigures(group, arms, plans, figures);
  AddRunFigures(arms, drawn, shown_missions, figures);
  return figures;
}

}  // namespace ed3r::figures
