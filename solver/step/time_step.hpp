// One time step of position-based Cosserat rods, the algorithm of Shao et al. 2021 (after Deul et al. 2018):
//
//   free flight from v, w to x*, q* (free_flight.hpp); held segments move to their pose at the end of the step
//   contacts, if the scene has any, are found from x and x*
//   lambda = 0;  Newton: project every rod until max |C + alpha~ lambda| is below the tolerance, then the contacts
//   with alpha~ = alpha / dt_c^2, dt_c^2 = h^2 / (1 + c h): drag is implicit, forces are J^T lambda / dt_c^2
//   v, w from the motion (free_flight.hpp)
// Here h is dt, or less in a step of BDF2 (free_flight.hpp).
// If the projection keeps the balance of momentum (momentum_balance.hpp), Newton starts from the last step's lambda,
// from x + h (2 v - v_before) and q likewise. It ends when momentum is in balance as well. If two thirds of the
// iterations do not come near that (a slender rod that hits the floor end-on can fold in many ways), the step is undone
// and repeated as above. After a step that did not reach balance, 1, 2, 4, ... up to 16 steps do not try, so that scenes
// where Newton cannot converge in time cost little more than without balance.
// With internal damping, C has a part of its rate (internal_damping.hpp).
// Loads: gravity and point loads as of the end of the step, and the wind's drag (wind.hpp), at the start of a step of
// Euler, at the expected end of one of BDF2; in balance, torques of point loads act in g. A rod that hits something takes that step and the next two as
// Euler's: with the velocity before an impact, BDF2 would rebound. Nothing allocates after construction, except for
// contacts (contact_projection.hpp).
#pragma once

#include <memory>
#include <vector>

#include "solver/contact/contact_projection.hpp"
#include "solver/scene/scene.hpp"
#include "solver/step/free_flight.hpp"
#include "solver/step/internal_damping.hpp"
#include "solver/step/projection.hpp"

namespace rodsweep {

struct StepSettings {
  double dt = 0.02;                ///< [s]
  int newton_iterations = 6;       ///< limit
  double newton_tolerance = 1e-9;  ///< on max |C + alpha~ lambda|
  Integrator integrator = Integrator::euler;
};

struct StepReport {
  SolveOutcome outcome = SolveOutcome::converged;  ///< the last failure of a solve, else converged
  int newton_iterations = 0;                       ///< solves used: maximum over rods and contacts
  bool balanced = false;                           ///< momentum is in balance at the end, to 1e-3 at least
  int contacts = 0;                                ///< number of contacts
  double penetration = 0, contact_residual = 0;    ///< at the end of the step, see ContactState
};

/// What held segments and obstacles exert on the rods, each about the origin. The weight and the inertia of held
/// segments are not part of it.
struct Reactions {
  Action clamps, obstacles;
};

/// dt_c of a step with h: it converts compliances to alpha~ and multipliers to forces.
double constraint_dt(const Scene& scene, double h);

class TimeStepper {
 public:
  TimeStepper(Scene& scene, const StepSettings& settings);

  /// Advances the scene by dt. A failed solve ends the step; the state of the rods is invalid then.
  StepReport step(Projection& projection);

  /// Of the last step. In balance, the momentum of the free segments changes by these and the loads.
  Reactions reactions() const;

  int steps_taken() const { return steps_; }

  /// See FreeFlight. To continue a simulation: the scene has its time, poses, velocities and multipliers, and each rod
  /// continues from its motion a step before. In contact, impulses and impacts of earlier steps are not known.
  RodMotion before(int rod) const { return flights_[at(rod)].before(scene_.rods[at(rod)]); }
  void continue_from(int rod, const RodMotion& before);

 private:
  enum class Newton { converged, open, failed };

  void start();
  void find_loads();
  void predict(bool balanced);
  void take_back(Projection& projection, StepReport& report);
  Newton iterate(Projection& projection, int until, StepReport& report);
  double end_of_step() const { return start_time_s_ + (steps_ + 1) * settings_.dt; }
  void pause_balance(bool tried, bool balanced);
  bool is_near_balance(double momentum) const;  ///< `momentum`: limit of the last iteration's residual
  bool is_lost(Newton balanced) const;          ///< whether a balanced attempt that ended so must be undone

  Scene& scene_;
  StepSettings settings_;
  double start_time_s_;
  int steps_ = 0;
  int pause_ = 0, paused_ = 0;             ///< steps that do not try to balance momentum: in a row, and still to come
  std::vector<FreeFlight> flights_;        ///< of every rod
  std::vector<InternalDamping> dampings_;  ///< likewise; none without internal damping
  std::vector<SegmentLoads> loads_;        ///< point loads and wind, in free flight
  std::vector<Vector3> torques_nm_;        ///< of point loads, about the segments' centres
  double newton_residual_ = 0, momentum_residual_ = 0;  ///< maxima of the last iteration
  std::unique_ptr<ContactProjection> contact_;          ///< null in a scene without contacts
};

}  // namespace rodsweep
