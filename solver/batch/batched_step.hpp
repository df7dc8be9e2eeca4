// The time step of time_step.hpp with the direct solve, for as many equal chains at once as a register has lanes. This
// makes data generation fast. A rod's result equals that of a single rod up to rounding, and has the same bits in every
// batch: a converged lane does not change while the others iterate, and a lane whose solve failed does not change
// again. Nothing allocates after construction.
#pragma once

#include <optional>
#include <vector>

#include "solver/batch/batched_system.hpp"
#include "solver/step/time_step.hpp"

namespace rodsweep {

class BatchedStepper {
 public:
  /// Copies the scenes' rods. Throws as BatchedRods does. `momentum_tolerance`: steps keep the balance of momentum.
  BatchedStepper(const std::vector<Scene>& scenes, const StepSettings& settings,
                 std::optional<double> momentum_tolerance = {});

  /// Advances all rods whose steps have not failed by dt. One report per rod; a failed one repeats its outcome.
  const std::vector<StepReport>& step();

  // step() in parts, to access the systems: begin(); solve() while linearize() is true; end().
  void begin();
  bool linearize();  ///< the system at the rods' positions; false if no rod iterates
  void solve();      ///< solves the system and moves the rods
  const std::vector<StepReport>& end();

  /// Whether this rod's system is solved, from one linearize() to the next.
  bool iterates(int rod) const { return running_[rod] != 0; }
  const BatchedSystem& system() const { return system_; }
  /// Writes the solution of this rod's system, six multipliers a joint.
  void write_solution(int rod, double* solution) const { system_.write_solution(rods_, rod, solution); }
  bool keeps_balance(int rod) const { return balanced_[rod] != 0; }

  /// Stops this rod.
  void abandon(int rod) { sound_[rod] = 0; }

  int steps_taken(int rod) const { return steps_[static_cast<std::size_t>(rod)]; }

  /// Writes the state of a rod and its time into the scene that it came from, or an equal one.
  void write(int rod, Scene& scene) const;

 private:
  void fly();
  void forget_multipliers(const LaneMask& where);
  void take_back(const LaneMask& rods);
  void update_velocities();

  StepSettings settings_;
  BatchedRods rods_;
  BatchedSystem system_;
  LaneMask sound_;     ///< rods whose steps have not failed
  LaneMask running_;   ///< the sound rods that have not converged in this step
  LaneMask balanced_;  ///< the sound rods that keep the balance of momentum
  std::optional<double> momentum_tolerance_;
  std::vector<LanePose> past_;      ///< of the segments, of which velocities are differences
  std::vector<LaneMotion> before_;  ///< at the start of the last step; empty if nothing reads it
  int known_ = 0;                   ///< motions: 0, 1 (now) or 2 (before)
  bool uses_two_steps_ = false;
  double h_;        ///< of the step (integrator.hpp)
  int newton_ = 0;  ///< solves of this step
  std::vector<double> start_time_s_;
  std::vector<int> steps_;
  std::vector<StepReport> reports_;
};

}  // namespace rodsweep
