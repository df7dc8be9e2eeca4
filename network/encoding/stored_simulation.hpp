// A recorded simulation for training: for every stored linear system the state from which it was assembled and its
// exact solution. From these A, b and every feature can be formed again, bit for bit.
//
//   assemble_again(system, rod, linear_system)   gives A and b, and A solution = b
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "solver/scene/scene.hpp"
#include "solver/step/projection.hpp"

namespace rodsweep {

/// The data of the balance of momentum, an entry per segment.
struct StoredBalance {
  std::vector<Vector3> free_position;
  std::vector<Quaternion> free_orientation;
  std::vector<Vector6> contact_impulse;
};

/// One linear system. Vectors have an entry per segment, `lambda` and `solution` six per joint.
struct StoredSystem {
  SolvePosition at;
  double constraint_dt_s = 0;     ///< constraint_dt of the rod's step
  std::vector<Vector3> position;  ///< where the system was assembled [m]
  std::vector<Quaternion> orientation;
  std::vector<Vector3> velocity;           ///< at the start of the step [m/s]
  std::vector<Vector3> angular_velocity;   ///< at the start of the step [rad/s]
  VectorX lambda;                          ///< before the solve [kg m^2]
  VectorX solution;                        ///< the increment of lambda [kg m^2]
  std::optional<StoredBalance> balance{};  ///< if the system has g and K (momentum_balance.hpp)
};

struct StoredSimulation {
  Scene scene;                        ///< at its start, with the constant masses, joints and loads
  double step_s = 0;                  ///< time step
  int newton_iterations = 0;          ///< limit per step
  std::vector<StoredSystem> systems;  ///< in the order in which they were solved
};

/// Sets the rod `system.at.rod` of the scene to the state from which the system was assembled. Throws
/// std::invalid_argument if the rod has another number of segments or joints.
void restore(const StoredSystem& system, Rod& rod);

/// The same, and assembles the system that was solved, with or without the balance of momentum.
void assemble_again(const StoredSystem& stored, Rod& rod, LinearSystem& system);

/// Repeats a simulation without solving: sets one rod after the other to a stored state and assembles its system.
class Replay {
 public:
  explicit Replay(const StoredSimulation& simulation);  ///< `simulation` must outlive this

  const Scene& scene() const { return scene_; }
  const std::vector<LinearSystem>& systems() const { return systems_; }  ///< of each rod, as last assembled

  /// Calls visit(stored system, its rod, its linear system) for every system in order.
  template <class Visit>
  void run(Visit visit) {
    for (const StoredSystem& stored : simulation_.systems) {
      const auto r = static_cast<std::size_t>(stored.at.rod);
      assemble_again(stored, scene_.rods[r], systems_[r]);
      visit(stored, std::as_const(scene_.rods[r]), std::as_const(systems_[r]));
    }
  }

 private:
  const StoredSimulation& simulation_;
  Scene scene_;
  std::vector<LinearSystem> systems_;
};

}  // namespace rodsweep
