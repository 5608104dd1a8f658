// The energy ledger of one timestep (Eqs. 1-9; R5: hovering is billed while the robot senses, computes or transmits).
#pragma once

#include "engine/robot/energy.h"

namespace ed3r::robot {

// Seconds of one timestep, by what they were spent on.
struct StepTime {
  double horizontal_s = 0.0, ascent_s = 0.0, descent_s = 0.0, turning_s = 0.0;
  double sensing_s = 0.0, computing_s = 0.0, transmitting_s = 0.0;

  double TotalS() const {
    return horizontal_s + ascent_s + descent_s + turning_s + sensing_s + computing_s + transmitting_s;
  }
};

// Joules of one timestep. The robot hovers while it turns, senses, computes and transmits.
struct StepEnergy {
  double horizontal_j = 0.0, ascent_j = 0.0, descent_j = 0.0;
  double hover_turning_j = 0.0, hover_sensing_j = 0.0, hover_computing_j = 0.0, hover_transmitting_j = 0.0;
  double sensing_j = 0.0, computation_j = 0.0, transmission_j = 0.0;

  double MovementJ() const {  // E_movement(t_k), hovering included
    return horizontal_j + ascent_j + descent_j + hover_turning_j + hover_sensing_j + hover_computing_j +
           hover_transmitting_j;
  }
  double TotalJ() const { return MovementJ() + sensing_j + computation_j + transmission_j; }
};

// Device energies are what sensors, CPU and radio draw on top of hovering.
struct DeviceEnergy {
  double sensing_j = 0.0, computation_j = 0.0, transmission_j = 0.0;
};

StepEnergy Charge(const MovementPower& power, const StepTime& time, const DeviceEnergy& devices);

}  // namespace ed3r::robot
