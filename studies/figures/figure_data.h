// Everything that figures show, as one JSON document (DIR/report/figures/data.json), so that anyone can draw them anew.
//
//   format            of this layout: 1
//   name              of the sweep
//   units             what each column of a mission is, with its unit
//   arms              list, in plan order:
//     key             name, "STAGE/NAME" where another stage has one of that name
//     stage, name, label
//     warmup          true for missions that networks learnt from
//     strategy, eta_min_pct, world    as the plan sets them; null where it is not known
//     missions, failed, missing, networks
//     metrics         as in report.json: METRIC: {mean, lo, hi, n, paper}, 95 % intervals
//     per_mission     columns of equal length, in mission order: see `units`; null is "none"
//     sites           list: {site, known, missions, success_pct, lo, hi, false_positive_pct, depleted_pct}
//                     intervals as in the tables (the luck of training included), null where a site has one mission
//     known_sites, unseen_sites    the same, pooled: the report's generalisation; null without missions
//     convergence     METRIC: {missions: [n...], half_width: [...], half_width_missions: [...]}: of the 95 % interval
//                     that the first n missions give, with and without the luck of training (studies/claims/convergence.h)
//   figures           list: {id, kind, title, caption, arms: [key...], warmups: [key...]}: see figure_list.h
//   variants          of a sweep that has them, else null; the arms above are then those of the first variant:
//                     {base, names: [the others...], differences: [{arm, variant, metric, difference, lo, hi, certain}]}
//                     as in variants.csv (studies/variants/variants.h); null is "none"
//   missions_shown    list: {arm, mission, outcome, site, base_station, duration_min, energy_kj,
//                     x_m, y_m, z_m, scs_pct}: positions after each timestep, the start first (its SCS is null)
//   world             of missions_shown, null where it is not at hand (world_note says why):
//                     {name, size_m, cell_m, height_m: rows from south to north, trees: [[x_m, y_m, crown radius_m]...],
//                     sites: [{name, x_m, y_m, known}], base_stations: likewise}
//
// Numbers of missions and of the world are rounded to what a figure can show: 4 decimals and 0.1 m.
#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "engine/world/scene.h"
#include "studies/figures/figure_list.h"
#include "studies/figures/run_source.h"
#include "studies/metrics/metrics.h"
#include "studies/variants/variants.h"

namespace ed3r::figures {

struct FigureInputs {
  std::string name;
  std::span<const metrics::ArmData> arms;
  std::span<const metrics::ArmMetrics> metrics;  // of the arms, in their order
  std::span<const ArmPlan> plans;
  std::span<const ShownMission> missions;
  std::shared_ptr<const world::Scene> scene;  // of the missions; null: none
  std::string scene_note;
  const variants::VariantStudy* variants = nullptr;
};

// Pure: the same inputs give the same document.
nlohmann::ordered_json MakeFigureData(const FigureInputs& inputs);

}  // namespace ed3r::figures
