// An unbranched rod as functions of its arc length, without units: rods of any size and division are comparable.
//
// sigma in [0, 1] runs over the free segments from the static end (if none or both are static: from the end with the
// lower number); static segments have no length. Units: the free length L, the free mass m, the magnitude a of the
// scene's gravity (1 m/s^2 if it is zero), T = sqrt(L / a). At every joint, of length l:
//   state   15: its point relative to the first joint's, over L
//               L / l (-b_b): L (Omega - Omega0), plus the multipliers' term
//               the sum of l b_s / (a dt_c^2) up to this joint, in the world: equal for a clamp's jump and spread gaps
//               T / L times the velocity of the point, T times the angular velocity
//   load     6: force lambda_s / (l dt_c^2) over m a, torque lambda_b / dt_c^2 over m a L, in the joint's frame.
//               Neither depends on the number of segments or, except for the motion in a step, on dt.
//   constants 2: log10 of EI and GJ over m a L^2, means over the joints
#pragma once

#include <vector>

#include "network/layers/tensor.hpp"
#include "solver/linear/linear_system.hpp"

namespace rodsweep {

class ChainProfile {
 public:
  static constexpr int state_size = 15, constant_count = 2;
  static constexpr int shape_size = 6;            ///< the state's first features: positions and curvature
  static const std::vector<int>& state_groups();  ///< for network/encoding/normalisation.hpp

  /// Throws SceneError for a rod with branches, loops or several pieces, or without free segments.
  ChainProfile(const Rod& rod, const Vector3& gravity_m_s2);

  const std::vector<float>& arc() const { return arc_; }  ///< sigma of the joints, ascending
  const Eigen::Array2f& constants() const { return constants_; }

  /// [state_size, joints] of the system assembled at the rod's state with dt_c. Allocates nothing.
  void state(const Rod& rod, const LinearSystem& system, double dt_c, Tensor<float>& out) const;
  /// [6, joints] from multipliers, and back.
  void loads(const VectorX& multipliers, double dt_c, Tensor<float>& out) const;
  void multipliers(const Tensor<float>& loads, double dt_c, VectorX& out) const;

 private:
  Vector6 load_unit(std::size_t place, double dt_c) const;

  std::vector<int> joint_;      ///< along the rod
  std::vector<double> length_;  ///< l
  std::vector<double> sign_;    ///< -1 if a is the farther segment: C and lambda are reversed
  std::vector<float> arc_;
  double length_m_ = 0, mass_kg_ = 0, acceleration_m_s2_;
  Eigen::Array2f constants_;
};

/// Adds `weight` times the values [n, from.size()] at `from` to the columns of `out`, at `to`, with linear
/// interpolation and extrapolation. `from` and `to` ascend.
void add_resampled(const std::vector<float>& from, const Eigen::Ref<const Tensor<float>>& values,
                   const std::vector<float>& to, float weight, Eigen::Ref<Tensor<float>> out);

}  // namespace rodsweep
