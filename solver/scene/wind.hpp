// Wind and its drag on a segment. SI; y is up. Throws SceneError.
//
//   u(x, t) = U h(y) (1 + g sin(2 pi t / T)) + sum over m of a_m cos(k_m . (x - U t) + w_m t + phi_m)
//
// U mean, g and T strength and period of gusts, h = (y / y_ref)^p a power law above the ground (p = 0: 1). The sum is
// turbulence after Kraichnan (1970): a_m is perpendicular to k_m, so its divergence is zero; it drifts with the
// mean (Taylor's frozen turbulence) and changes by itself. k_m is drawn from a normal distribution of deviation 1/L in
// each component, w_m from one of deviation sigma |k_m|; all |a_m| are sigma sqrt(6 / modes). So <u'.u'> = 3 sigma^2,
// and with more and more modes correlations over a distance r, and over a time t in the drifting air, tend to
//
//   exp(-r^2 / 2 L^2),   (1 + (sigma t / L)^2)^(-3/2)
//
// Drag of a segment of length l and diameter d, by the velocity u of the air past its centre, u_n across and u_t along
// it (the cross-flow principle, Hoerner 1965):
//
//   F = 1/2 rho C_d d l |u_n| u_n + 1/2 rho C_f pi d l |u_t| u_t
//
// TimeStepper evaluates it where a step starts, or by BDF2 where it is expected to end: exact at rest. The factors k = 1/2 rho C d l
// |u| are limited to m / dt, above which drag would overshoot within a step: so it never accelerates a segment past the
// air. Implicit drag in the prediction would be as stable, but the multipliers do not contain it: constraints would
// balance a drag that is too small by 1 + dt k / m.
#pragma once

#include <cstdint>
#include <vector>

#include "solver/numbers/lanes.hpp"
#include "solver/numbers/types.hpp"
#include "solver/rod/rod.hpp"

namespace rodsweep {

struct WindParameters {
  Vector3 mean_m_s{0, 0, 0};
  double gust_strength = 0;        ///< g
  double gust_period_s = 5;        ///< T
  double turbulence_m_s = 0;       ///< sigma, root mean square of each component
  double turbulence_length_m = 2;  ///< L
  int turbulence_modes = 16;
  std::uint64_t seed = 0;
  double profile_exponent = 0;     ///< p
  double reference_height_m = 10;  ///< y_ref
  double air_density_kg_m3 = 1.2;
  double drag_coefficient = 1.2;       ///< C_d
  double friction_coefficient = 0.01;  ///< C_f
};

class Wind {
 public:
  explicit Wind(const WindParameters& parameters);

  Vector3 velocity(const Vector3& position_m, double time_s) const;

  /// Drag on a free segment, in a step of dt.
  Vector3 drag(const Segment& segment, const Vector3& position_m, const Vector3& direction, const Vector3& velocity_m_s,
               double time_s, double dt) const;

 private:
  /// A mode in each lane; rate w - k . U. Angles are in turns, unused lanes have zero amplitude.
  struct Modes {
    Lane amplitude[3], wave[3], rate, phase;
  };
  WindParameters p_;
  std::vector<Modes> modes_;
};

}  // namespace rodsweep
