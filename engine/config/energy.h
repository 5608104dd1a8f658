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

struct EnergyConfig {
  HoverForm hover_form = HoverForm::kPhysical;
  VerticalForm vertical_form = VerticalForm::kPrinted;
  MoveOrder move_order = MoveOrder::kHorizontalFirst;
  MoveTime move_time = MoveTime::kFlown;

  template <class Self, class Visitor>
  static void Describe(Self& self, Visitor&& visit) {
    visit("hover_form", self.hover_form,
          {.source = "R1",
           .meaning = "P_hov with rho A below the line (physical, 135.3 W) or above it (printed, 5.2 W)"});
    visit("vertical_form", self.vertical_form,
          {.source = "R3",
           .meaning = "P_ver = m g +- drag (printed), P_hov + m g v (climb), or m g v + drag (mgv)"});
    visit("move_order", self.move_order, {.source = "R4", .meaning = "which leg of a move is flown first"});
    visit("move_time", self.move_time,
          {.source = "R4", .meaning = "bill the times that were flown, or distance / speed"});
  }
};

}  // namespace ed3r
