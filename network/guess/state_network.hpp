// A simulator that updates the state of rods directly, without constraints (Sanchez-Gonzalez et al. 2020):
//
//   v_{n+1} = v_n + dt a,   w likewise,   x_{n+1} = x_n + dt v_{n+1},   q_{n+1} = rotated(q_n, dt w_{n+1})
// with a graph network's accelerations a from the last five velocities (network/encoding/state_encoding.hpp),
// semi-implicit, once a step; static segments do not move. Contacts, if the scene has any, act after it. Joints are not
// enforced.
#pragma once

#include <memory>
#include <vector>

#include "network/encoding/state_encoding.hpp"
#include "network/processor/model.hpp"
#include "solver/step/projection.hpp"

namespace rodsweep {

class StateNetworkProjection : public Projection {
 public:
  /// `scene` is before its first step of dt. Throws std::invalid_argument for a model of another encoding.
  StateNetworkProjection(const Scene& scene, std::shared_ptr<const Model> model, double dt);

  /// Acts in the first iteration of a step; returns not_run in the others. Returns `converged` if it applied the moves,
  /// and `not_a_number`, with the rod unchanged, if they are not finite. Allocates nothing after a rod's first step.
  ProjectionReport project(Rod& rod, const SolvePosition& at, double dt_c, double newton_tolerance) override;

 private:
  struct OfRod {
    StateEncoding encoding;
    StateHistory history;
    Tensor<float> nodes, edges, y_edges, y_nodes;
    CopingNet<float>::Tape tape;
  };
  std::shared_ptr<const Model> model_;
  double dt_;
  std::vector<OfRod> rods_;
};

}  // namespace rodsweep
