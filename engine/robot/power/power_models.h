// What a multirotor draws while it moves: the paper's three powers, and a momentum-theory model that real
// flight logs need (READINGS R1-R5; `ed3r fit` estimates the parameters of either). The mission ledger and
// the fit use the very same formulas: they are templates over the scalar, `double` in a mission, an
// automatic-differentiation type in the fit. Only + - * / and sqrt are used, so a power has the same bits on
// every machine.
//
// Speeds are relative to the air. All functions are pure and thread-safe.
#pragma once

#include <algorithm>
#include <cmath>

#include "engine/config/energy.h"
#include "engine/config/robot.h"

namespace ed3r::robot {

// The body as the formulas see it.
struct Rotorcraft {
  double mass_kg{};
  int propellers{};
  double propeller_area_m2{};  // A_prop = pi r^2 of one propeller
  double front_area_m2{};      // faces horizontal motion
  double top_area_m2{};        // faces vertical motion

  double DiscAreaM2() const { return propellers * propeller_area_m2; }
};

Rotorcraft MakeRotorcraft(const RobotConfig& robot);

struct Air {
  double density_kgm3{};
  double gravity_mps2{};
};

// The paper's model (Appendix, Power for Movement Energy Estimation). Its powers are mechanical; `efficiency`
// is mechanical over electrical power and 1 in the paper.
template <class T = double>
struct PaperParameters {
  T efficiency{EnergyConfig{}.paper_efficiency};
  T drag_horizontal{RobotConfig{}.drag_horizontal};  // C_dh
  T drag_vertical{RobotConfig{}.drag_vertical};      // C_dv
};

template <class T = double>
struct PaperPower {
  T hover_w, horizontal_w, ascent_w, descent_w;
};

// Momentum theory for the whole set of rotors, with what small multirotors add to it:
//
//   P = [ kappa (1 + chi (1 - cos X)) T v_i  +  c_p T^1.5 / sqrt(2 rho A)  +  D V  +  m g v_v ] / efficiency
//
//   T    thrust that balances weight and parasite drag D = rho/2 f V^2, tilted into the flight direction
//   v_i  induced velocity of Glauert's equation v_i sqrt(V_p^2 + (V_a + v_i)^2) = T / (2 rho A), V_a and V_p
//        the airspeed along and across the thrust: it falls with speed (translational lift) and with climb
//   X    skew angle of the wake. In hover (X = 0) the rotors work apart; in forward flight the rear ones work
//        in the wake of the front ones, which costs a share chi of the induced power. Without it no setting
//        follows both the level flights and the climbs of the Matrice 100 logs. The form 1 - cos X was chosen
//        on them: powers of sin X fit the rows as well, but one that is not flat at X = 0 makes still-air
//        hover 5 to 8 % too cheap (real hover always has some wind, so no row corrects it).
//   c_p  profile power. Rotor speed squared follows thrust, hence T^1.5, like induced power in hover, from
//        which only forward flight can tell it: kappa + c_p is well determined, their shares may not be. Its
//        weak growth with forward speed is part of f.
//
// Hover is m^1.5 sqrt(g^3 / (2 rho A)) (kappa + c_p) / efficiency: the paper's P_hov times a constant.
// Descent follows the hover branch of Glauert's equation down to an axial flow of -v_i(hover), some 6 m/s;
// faster descent saves no more. In that range (vortex-ring state) momentum theory is an approximation from
// below. A descent never charges the battery. Defaults: the Matrice 100, fitted.
template <class T = double>
struct MomentumParameters {
  T efficiency{EnergyConfig{}.momentum_efficiency};
  T induced_factor{EnergyConfig{}.induced_factor};  // kappa
  T interference{EnergyConfig{}.interference};      // chi
  T profile_share{EnergyConfig{}.profile_share};    // c_p
  T drag_area_m2{EnergyConfig{}.drag_area_m2};      // f
};

template <class T = double>
struct MomentumPower {
  T induced_w, profile_w, parasite_w, climb_w;  // electrical; climb_w is negative in descent
  T TotalW() const { return induced_w + profile_w + parasite_w + climb_w; }
};

// m^1.5 sqrt(g^3 / (2 rho A)), A the area of all propellers: the least power that momentum theory allows in
// hover, and P_hov in its physical form (R1).
double IdealHoverPowerW(double mass_kg, double density_kgm3, double gravity_mps2, double disc_area_m2);

// P_hov of the paper at efficiency 1, in the physical or the printed form (R1).
double PaperHoverW(const Rotorcraft& craft, const Air& air, HoverForm form);

// The four powers at a horizontal speed v_h and a vertical speed v_v, both magnitudes >= 0 (R1-R3). In the climb form
// a descent takes at least 0; the printed forms are left as they are, at any values.
template <class T>
PaperPower<T> PaperPowersW(const PaperParameters<T>& parameters, const Rotorcraft& craft, const Air& air,
                           double horizontal_mps, double vertical_mps, HoverForm hover_form,
                           VerticalForm vertical_form) {
  const T hover(PaperHoverW(craft, air, hover_form));
  const double pressure = 0.5 * air.density_kgm3;
  const T horizontal_drag = parameters.drag_horizontal * (pressure * craft.front_area_m2 * horizontal_mps *
                                                          horizontal_mps * horizontal_mps);
  const T vertical_drag =
      parameters.drag_vertical * (pressure * craft.top_area_m2 * vertical_mps * vertical_mps * vertical_mps);
  const double weight_n = craft.mass_kg * air.gravity_mps2;
  T ascent{}, descent{};
  switch (vertical_form) {
    case VerticalForm::kPrinted:
      ascent = weight_n + vertical_drag;
      descent = weight_n - vertical_drag;
      break;
    case VerticalForm::kClimb:
      ascent = hover + weight_n * vertical_mps;
      descent = hover - weight_n * vertical_mps;
      if (descent < T(0.0)) descent = T(0.0);  // it does not charge the battery
      break;
    case VerticalForm::kMgv:
      ascent = weight_n * vertical_mps + vertical_drag;
      descent = weight_n * vertical_mps - vertical_drag;
      break;
  }
  const T& efficiency = parameters.efficiency;
  return {hover / efficiency, (hover + horizontal_drag) / efficiency, ascent / efficiency,
          descent / efficiency};
}

namespace power_detail {

inline double ValueOf(double x) { return x; }
template <class Jet>
requires requires(const Jet& x) { x.a; }
double ValueOf(const Jet& x) { return x.a; }

// One Newton step on F(v) = v sqrt(V_p^2 + (V_a + v)^2) - h^2.
template <class T>
T InducedStep(const T& v, const T& axial, const T& across, const T& hover_squared) {
  using std::sqrt;
  const T flow = sqrt(across * across + (axial + v) * (axial + v));
  return v - (v * flow - hover_squared) / (flow + v * (axial + v) / flow);
}

}  // namespace power_detail

// Solves Glauert's equation. axial, across: airspeed along and across the thrust; hover_squared = T / (2 rho
// A) > 0 is the square of the induced velocity in hover, and axial >= -that velocity, where the root is
// unique. Newton from the nearer of two upper bounds (purely axial flow; fast flow across): a fixed number of
// steps in double, enough for full precision, then one step in T, which carries the exact derivative of the
// root (implicit function theorem).
template <class T>
T InducedVelocityMps(const T& axial, const T& across, const T& hover_squared) {
  using power_detail::ValueOf;
  constexpr int kSteps = 4;
  const double a = robot::power_detail::ValueOf(axial), p = robot::power_detail::ValueOf(across),
               h2 = robot::power_detail::ValueOf(hover_squared);
  double v = -0.5 * a + std::sqrt(0.25 * a * a + h2);
  if (v * p > h2) v = h2 / p;
  for (int step = 0; step < kSteps; ++step) v = power_detail::InducedStep(v, a, p, h2);
  return power_detail::InducedStep(T(v), axial, across, hover_squared);
}

// The shares of the electrical power at airspeed (horizontal_mps >= 0, climb_mps: up positive).
template <class T>
MomentumPower<T> MomentumPowersW(const MomentumParameters<T>& parameters, double mass_kg,
                                 double horizontal_mps, double climb_mps, const Air& air,
                                 double disc_area_m2) {
  using std::sqrt;
  const double weight_n = mass_kg * air.gravity_mps2;
  const double speed = std::sqrt(horizontal_mps * horizontal_mps + climb_mps * climb_mps);
  const T drag_per_mps = (0.5 * air.density_kgm3 * speed) * parameters.drag_area_m2;  // D / V
  const T thrust_x = drag_per_mps * horizontal_mps;
  const T thrust_z = weight_n + drag_per_mps * climb_mps;
  const T thrust = sqrt(thrust_x * thrust_x + thrust_z * thrust_z);
  T axial = (thrust_z * climb_mps + thrust_x * horizontal_mps) / thrust;
  const T across = (weight_n * horizontal_mps) / thrust;  // drag is parallel to the airspeed and drops out
  const T hover_squared = thrust / (2.0 * air.density_kgm3 * disc_area_m2);
  const T hover_velocity = sqrt(hover_squared);
  if (axial < -hover_velocity) axial = -hover_velocity;
  const T induced = InducedVelocityMps(axial, across, hover_squared);
  const T through = axial + induced;
  const T skew = 1.0 - through / sqrt(across * across + through * through);  // 1 - cos X

  const T per_efficiency = 1.0 / parameters.efficiency;
  MomentumPower<T> power;
  power.induced_w =
      per_efficiency * parameters.induced_factor * (1.0 + parameters.interference * skew) * thrust * induced;
  power.profile_w = per_efficiency * parameters.profile_share * thrust * hover_velocity;
  power.parasite_w = per_efficiency * drag_per_mps * (speed * speed);
  power.climb_w =
      per_efficiency * thrust * axial - power.parasite_w;  // = m g v_v / efficiency within the limit
  const T rest = power.induced_w + power.profile_w + power.parasite_w;
  if (power.climb_w < -rest) power.climb_w = -rest;
  return power;
}

template <class T>
T MomentumPowerW(const MomentumParameters<T>& parameters, double mass_kg, double horizontal_mps,
                 double climb_mps, const Air& air, double disc_area_m2) {
  return MomentumPowersW(parameters, mass_kg, horizontal_mps, climb_mps, air, disc_area_m2).TotalW();
}

}  // namespace ed3r::robot
