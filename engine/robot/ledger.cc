#include "engine/robot/ledger.h"

namespace ed3r::robot {

StepEnergy Charge(const MovementPower& power, const StepTime& time, const DeviceEnergy& devices) {
  StepEnergy energy;
  energy.horizontal_j = power.horizontal_w * time.horizontal_s;
  energy.ascent_j = power.ascent_w * time.ascent_s;
  energy.descent_j = power.descent_w * time.descent_s;
  energy.hover_turning_j = power.hover_w * time.turning_s;
  energy.hover_sensing_j = power.hover_w * time.sensing_s;
  energy.hover_computing_j = power.hover_w * time.computing_s;
  energy.hover_transmitting_j = power.hover_w * time.transmitting_s;
  energy.sensing_j = devices.sensing_j;
  energy.computation_j = devices.computation_j;
  energy.transmission_j = devices.transmission_j;
  return energy;
}

}  // namespace ed3r::robot
