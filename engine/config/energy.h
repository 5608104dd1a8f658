// Which reading of the energy model is in force (R1-R5).
#pragma once

#include "engine/config/field.h"

namespace ed3r {

enum class HoverForm { kPhysical, kPrinted };
template <>
struct EnumNames<HoverForm> {
  static constexpr EnumName<HoverForm> kNames[] = {{HoverForm::kPhysical, "physical"},
                                                   {HoverForm::kPrinted, "printed"}};
};

enum class VerticalForm { kPrinted, kClimb, kMgv };
template <>
struct EnumNames<VerticalForm> {
  static constexpr EnumName<VerticalForm> kNames[] = {
      {VerticalForm::kPrinted, "printed"}, {VerticalForm::kClimb, "climb"}, {VerticalForm::kMgv, "mgv"}};
};

enum class MoveOrder { kHorizontalFirst, kVerticalFirst };
template <>
struct EnumNames<MoveOrder> {
  static constexpr EnumName<MoveOrder> kNames[] = {{MoveOrder::kHorizontalFirst, "horizontal-first"},
                                                   {MoveOrder::kVerticalFirst, "vertical-first"}};
};

enum class MoveTime { kFlown, kNominal };
template <>
struct EnumNames<MoveTime> {
  static constexpr EnumName<MoveTime> kNames[] = {{MoveTime::kFlown, "flown"},
                                                  {MoveTime::kNominal, "nominal"}};
};

enum class PowerModel { kPaper, kMomentum };
template <>
struct EnumNames<PowerModel> {
  static constexpr EnumName<PowerModel> kNames[] = {{PowerModel::kPaper, "paper"},
                                                    {PowerModel::kMomentum, "momentum"}};
};

struct EnergyConfig {
  PowerModel model = PowerModel::kPaper;
  HoverForm hover_form = HoverForm::kPhysical;
  VerticalForm vertical_form = VerticalForm::kPrinted;
  MoveOrder move_order = MoveOrder::kHorizontalFirst;
  MoveTime move_time = MoveTime::kNominal;
  double paper_efficiency = 1.0;
  double momentum_efficiency = 0.713;
  double induced_factor = 1.456;
  double profile_share = 0.0;
  double interference = 0.577;
  double drag_area_m2 = 0.0925;

  template <class Self, class Visitor>
  static void Describe(Self& self, Visitor&& visit) {
    visit("model", self.model,
          {.source = "R1-R3; ed3r fit",
           .meaning = "the paper's three powers, or momentum theory as real flights need it"});
    visit("hover_form", self.hover_form,
          {.source = "R1",
           .meaning = "P_hov with rho A below the line (physical, 135.3 W) or above it (printed, 5.2 W)"});
    visit("vertical_form", self.vertical_form,
          {.source = "R3",
           .meaning = "P_ver = m g +- drag (printed), P_hov + m g v (climb), or m g v + drag (mgv)"});
    visit("move_order", self.move_order, {.source = "R4", .meaning = "which leg of a move is flown first"});
    visit("move_time", self.move_time,
          {.source = "R4, calibrated", .meaning = "bill the times that were flown, or distance / speed"});
    constexpr std::string_view kFit = "ed3r fit, Matrice 100";
    visit("paper_efficiency", self.paper_efficiency,
          {.min = 0.05,
           .max = 1,
           .source = "1 in the paper; ed3r fit",
           .meaning = "mechanical over electrical power, model paper"});
    visit("momentum_efficiency", self.momentum_efficiency,
          {.min = 0.2,
           .max = 1,
           .source = kFit,
           .meaning = "mechanical over electrical power, model momentum"});
    visit("induced_factor", self.induced_factor,
          {.min = 1, .max = 2, .source = kFit, .meaning = "induced power over its ideal, kappa"});
    visit("profile_share", self.profile_share,
          {.min = 0, .max = 2, .source = kFit, .meaning = "profile power over ideal hover power, c_p"});
    visit("interference", self.interference,
          {.min = 0,
           .max = 1.5,
           .source = kFit,
           .meaning = "what rotors in the wake of others cost in forward flight, chi"});
    visit("drag_area_m2", self.drag_area_m2,
          {.unit = "m^2", .min = 0, .max = 0.5, .source = kFit, .meaning = "parasite drag area f"});
  }
};

}  // namespace ed3r
