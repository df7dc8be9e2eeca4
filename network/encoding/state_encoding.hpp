// The encoding `state`, for a simulator that updates the state of rods without constraints (Sanchez-Gonzalez et al.
// 2020, Learning to simulate complex physics with graph networks): the last five velocities give accelerations.
//
//   node 37: the last five velocities [m/s] and angular velocities [rad/s], newest first, v then w of each; gravity;
//            radius [m], density [kg/m^3], length [m], and whether fixed
//   edge 15: the joint's gap, (x_a + R_a arm_a - x_b - R_b arm_b) / l; (x_b - x_a) / l; l (Omega - Omega0);
//            l Omega0; log10 of Young's and torsion modulus; l [m]
//   output:  v_{n+1} - v_n [m/s] and w_{n+1} - w_n [rad/s], a step's accelerations times dt
// Vectors are in the segment's own frame, vectors of an edge in the frame of its segment a: rotating the scene does not
// change them (the paper uses the world frame). The gap and the strain are not in the paper. They are small differences
// of large numbers, which a network learns slowly. Rolling all frames about the segments' axes changes the features but
// not the physics; copies for training have random rolls.
#pragma once

#include <memory>
#include <vector>

#include "network/encoding/state_history.hpp"
#include "network/graph/topology.hpp"
#include "network/layers/tensor.hpp"

namespace rodsweep {

class StateEncoding {
 public:
  static const std::vector<int>& node_groups();
  static const std::vector<int>& edge_groups();

  StateEncoding(const Rod& rod, const Vector3& gravity_m_s2);

  const Topology& topology() const { return *topology_; }
  const std::shared_ptr<const Topology>& shared_topology() const { return topology_; }

  /// Sets [37, segments] and [15, places of the topology]. Allocates nothing.
  void encode(const Rod& rod, const StateHistory& history, Eigen::Ref<Tensor<float>> nodes,
              Eigen::Ref<Tensor<float>> edges) const;

  /// Sets the exact output [6, segments] for these next velocities; 0 for fixed segments.
  static void answer(const Rod& rod, const StateHistory& history, const std::vector<Vector3>& velocity,
                     const std::vector<Vector3>& spin, Eigen::Ref<Tensor<float>> out);

 private:
  Vector3 gravity_;
  std::shared_ptr<const Topology> topology_;
  Tensor<float> constants_;  ///< [4, segments]
  Tensor<float> moduli_;     ///< [2, joints]
};

/// Transforms columns, whose groups of three are vectors, to frames rolled by `angle` about their z.
void roll(const std::vector<int>& groups, double angle, Eigen::Ref<Tensor<float>> columns);

}  // namespace rodsweep
