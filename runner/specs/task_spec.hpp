// The settings of one task of a sweep, a simulation.
// Plain values; created by Plan (runner/plan/plan.hpp), run by run_task() (runner/measure/run_task.hpp).
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "runner/specs/guess_spec.hpp"
#include "solver/cg/conjugate_gradient.hpp"
#include "solver/scene/scenes.hpp"
#include "solver/step/gauss_seidel.hpp"
#include "solver/step/time_step.hpp"

namespace rodsweep {

enum class Evaluation {
  paired,      ///< the reference advances one trajectory; every guess is tried on every system
  closed_loop  ///< the task's own guess (or the direct solve) advances its own trajectory
};

enum class Method {
  direct,
  cg,
  end_to_end,     ///< a network's increments, without a solve
  state_network,  ///< a network's accelerations, without constraints
  pbd,            ///< \ Gauss-Seidel, without a linear system
  xpbd            ///< /
};

/// Whether the method applies a network's output unchecked.
inline bool is_network(Method method) { return method == Method::end_to_end || method == Method::state_network; }
/// Whether the method solves linear systems, so that its steps can balance momentum.
inline bool solves_systems(Method method) { return method == Method::direct || method == Method::cg; }
inline bool is_gauss_seidel(Method method) { return method == Method::pbd || method == Method::xpbd; }

/// Ends a simulation early: at rest (solver/step/relaxation.hpp).
struct Until {
  double rest = 0;  ///< tolerance of the forces
};

struct TimeSpec {
  double step_s = 0.02;
  Integrator integrator = Integrator::bdf2;
  int steps = 100;
  int newton_iterations = 20;        ///< maximum per step; Gauss-Seidel: its iterations
  double newton_tolerance = 1e-9;    ///< Newton ends when max |C + alpha~ lambda| falls below it
  bool balance = true;               ///< steps of direct and cg balance momentum (solver/rod/momentum_balance.hpp)
  double momentum_tolerance = 1e-4;  ///< with `balance`, Newton also requires its residual below this
  std::optional<Until> until;        ///< else all steps; its steps are those of Euler, and balance as well as it asks
};

inline StepSettings step_settings(const TimeSpec& time) {
  return {time.step_s, time.newton_iterations, time.newton_tolerance, time.integrator};
}

/// The solution that guesses are compared with; it advances the rod in a paired evaluation.
enum class Reference {
  direct,  ///< from the direct solve, which is also timed
  cg       ///< from CG from zero to the tightest tolerance, without factorisation
};

enum class Forcing { fixed, eisenstat_walker };

struct LearnedPreconditioner {
  std::filesystem::path model;
};

struct SolveSpec {
  Method method = Method::cg;
  Preconditioner preconditioner = Preconditioner::jacobi;
  Norm norm = Norm::true_residual;
  double tolerance =
      1e-2;  ///< of the timed solves and, in a closed loop, of the solves that advance the rod; relative to ||b||
  Forcing forcing = Forcing::fixed;       ///< otherwise `tolerance` is for a step's first solves (forcing_terms.hpp)
  int max_iterations = 0;                 ///< 0: ten times the number of unknowns
  int fill_levels = default_fill_levels;  ///< block_icc, condensed
  int lag_steps = 0;                      ///< time steps between setups of the preconditioner; 0: see kept_steps()
  int timing_repeats = 1;                 ///< times are medians over this many repeats of guess, solve and direct solve
  std::filesystem::path model;            ///< end_to_end, state_network
  std::optional<LearnedPreconditioner> learned;  ///< with Preconditioner::learned
  std::optional<PluginFile> plugin;              ///< with Preconditioner::plugin
  std::optional<PythonFile> python;              ///< with Preconditioner::python
  PbdStiffness stiffness;                        ///< pbd
  Reference reference = Reference::direct;       ///< cg

  bool is_direct() const {
    return method == Method::direct || (method == Method::cg && reference == Reference::direct);
  }

  /// Number of time steps for which a preconditioner is kept; 0: for one system.
  int kept_steps() const {
    constexpr int of_lagged_cholesky = 10;
    if (lag_steps > 0) return lag_steps;
    return preconditioner == Preconditioner::lagged_cholesky ? of_lagged_cholesky : 0;
  }
};

/// The linear systems that a data set stores: the states that they are assembled from, and the solutions.
enum class StoredSystems {
  none,   ///< a sweep
  first,  ///< the first Newton iteration of every step
  all
};

/// The settings under "record" in a job.
struct OutputSpec {
  bool solves = true;        ///< false: "summary", no /solves rows
  bool counts = true;        ///< false: no tight solves to count iterations
  bool other_norm = true;    ///< also count iterations in the norm that the job doesn't use
  int trajectory_every = 0;  ///< steps between frames; frame 0 is the initial state; 0: no trajectory
  StoredSystems systems = StoredSystems::none;
  bool states = false;  ///< in frames, for a start from them
  bool forces = false;  ///< of joints in frames, of clamps and obstacles in steps

  /// Number of Newton iterations per step, from the first, whose systems are stored.
  int stored_iterations(int newton_iterations) const {
    if (systems == StoredSystems::none) return 0;
    return systems == StoredSystems::first ? 1 : newton_iterations;
  }
};

/// A frame of another simulation, with its state, from which this one starts.
struct StartSpec {
  std::filesystem::path file;
  int task = 0;
  std::optional<double> time_s;   ///< of the frame; empty: the last one
  std::optional<double> clock_s;  ///< time at the start of this simulation; empty: that of the frame
};

/// The input of run_task().
struct TaskSpec {
  SceneSpec scene;
  std::optional<StartSpec> start;
  TimeSpec time;
  SolveSpec solve;
  Evaluation evaluation = Evaluation::paired;
  std::vector<GuessSpec> guesses;  ///< the file's whole guess axis, in order; empty for a direct simulation
  int own_guess = -1;              ///< closed loop with cg: index into `guesses` of this task's guess; else -1
  OutputSpec output;
  std::uint64_t seed =
      0;  ///< for guesses that draw random numbers; from the job's seed and the sample, shared by grid points
  double time_limit_s = 0;  ///< 0: none

  /// Whether every system is also solved directly: to advance the rods, as the reference, or for its time. In a closed
  /// loop with CG that records neither counts nor solves it would only take time.
  bool solves_directly() const { return solve.is_direct() && (own_guess < 0 || output.counts || output.solves); }
};

}  // namespace rodsweep
