// One task of a sweep: a concrete simulation with all its settings, and where its results live in the file.
// Plain values; made by Plan (runner/plan/plan.hpp), run by evaluate() (runner/experiment/evaluation.hpp).
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "runner/job/guess_spec.hpp"
#include "runner/job/rows.hpp"
#include "solver/cg/conjugate_gradient.hpp"
#include "solver/scene/scenes.hpp"
#include "solver/step/pbd_projection.hpp"

namespace rodsweep {

enum class Evaluation {
  paired,      ///< one trajectory advanced by the reference; every guess is tried on every system
  closed_loop  ///< the task's own guess (or the direct solve) advances its own trajectory
};

enum class Method {
  direct,
  cg,
  end_to_end,     ///< a network's increments, applied without a solve
  state_network,  ///< a network's accelerations, without any constraint
  pbd,            ///< \ Gauss-Seidel, without a linear system
  xpbd            ///< /
};

/// Applies what a network says, and nobody checks it.
inline bool is_network(Method method) { return method == Method::end_to_end || method == Method::state_network; }
inline bool is_gauss_seidel(Method method) { return method == Method::pbd || method == Method::xpbd; }

struct TimeSpec {
  double step_s = 0.02;
  int steps = 100;
  int newton_iterations = 6;         ///< at most this many per step; Gauss-Seidel: its iterations
  double newton_tolerance = 1e-9;    ///< Newton ends when max |C + alpha~ lambda| falls below it
  bool balance = false;              ///< steps keep the balance of momentum (solver/rod/momentum_balance.hpp)
  double momentum_tolerance = 1e-4;  ///< and Newton ends when its residual is below this as well
};

/// Whose solution a guess is measured against, and in a paired evaluation advances the rod.
enum class Reference {
  direct,  ///< of the direct solve, which is timed as well
  cg       ///< of cg from zero to the tightest tolerance: nothing is factorised
};

enum class Forcing { fixed, eisenstat_walker };

struct SolveSpec {
  Method method = Method::cg;
  Preconditioner preconditioner = Preconditioner::jacobi;
  Norm norm = Norm::true_residual;
  double tolerance =
      1e-2;  ///< of the timed solves and, in a closed loop, of the solves that advance the rod; relative to ||b||
  Forcing forcing = Forcing::fixed;       ///< else `tolerance` is that of a step's first solves (forcing_terms.hpp)
  int max_iterations = 0;                 ///< 0: ten times the number of unknowns
  int fill_levels = default_fill_levels;  ///< block_icc, condensed
  int lag_steps = 0;            ///< time steps from one set-up of the preconditioner to the next; 0: see kept_steps()
  int timing_repeats = 1;       ///< times are medians over so many repeats of guess, solve and direct solve
  std::filesystem::path model;  ///< end_to_end, state_network
  PbdStiffness stiffness;       ///< pbd
  Reference reference = Reference::direct;  ///< cg

  bool is_direct() const {
    return method == Method::direct || (method == Method::cg && reference == Reference::direct);
  }

  /// For how many time steps a preconditioner is kept; 0: for one system.
  int kept_steps() const {
    constexpr int of_lagged_cholesky = 10;
    if (lag_steps > 0) return lag_steps;
    return preconditioner == Preconditioner::lagged_cholesky ? of_lagged_cholesky : 0;
  }
};

/// Of which linear systems a data set holds what they were assembled from, and the solution.
enum class StoredSystems {
  none,   ///< a sweep
  first,  ///< the first Newton iteration of every step
  all
};

/// What a job says under "record".
struct OutputSpec {
  bool solves = true;        ///< false: "summary", no /solves rows
  bool other_norm = true;    ///< iterations also in the norm that the job doesn't test
  int trajectory_every = 0;  ///< a frame every so many steps, frame 0 the initial state; 0: no trajectory
  StoredSystems systems = StoredSystems::none;

  /// Newton iterations of a step, from the first, whose systems are stored.
  int stored_iterations(int newton_iterations) const {
    if (systems == StoredSystems::none) return 0;
    return systems == StoredSystems::first ? 1 : newton_iterations;
  }
};

/// Everything that evaluate() needs to know.
struct TaskSpec {
  SceneSpec scene;
  TimeSpec time;
  SolveSpec solve;
  Evaluation evaluation = Evaluation::paired;
  std::vector<GuessSpec> guesses;     ///< the file's whole guess axis, in order; empty for a plain direct simulation
  std::vector<std::uint8_t> settled;  ///< 1: a guess whose results are known, which is not tried; empty: all are
  int own_guess = -1;  ///< closed loop with cg: index into `guesses` of the guess that this task runs; else -1
  OutputSpec output;
  std::uint64_t seed =
      0;  ///< for guesses that draw random numbers; from the job's seed and the sample, shared by grid points
  double time_limit_s = 0;  ///< 0: none
};

/// A task's identity and its rows in the file. Sizes are upper bounds known at planning time.
struct Task {
  std::int64_t index = 0;  ///< row of /tasks
  std::int64_t point =
      0;  ///< parameter point (grid point and sample); closed-loop tasks that differ in their guess alone share it
  std::int64_t sample = 0;  ///< which draw of the random parameters, 0 .. samples-1
  int own_guess = -1;
  int segments = 0;  ///< dynamic and static ones (graph nodes)
  int joints = 0;
  std::int64_t steps = 0;
  std::int64_t frames = 0;  ///< of the trajectory
  PerRows<RowRange> rows;
  double cost = 0;  ///< relative; tasks are dispatched in descending order of it (segments x steps x newton_iterations)
};

}  // namespace rodsweep
