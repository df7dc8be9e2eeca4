// The linear solve of an experiment. Solves each system directly and with CG from every guess under test; counts
// iterations and measures times. One of the solutions advances the trajectory. With the reference "cg" there is no
// direct solve: the solution of CG from zero, known from the zero guess's untimed solve, replaces the direct one.
//
// Per system and guess:
// - One untimed solve per norm to the ladder's tightest tolerance; its history gives the iterations to all tolerances.
// - `timing_repeats` timed solves to the job's tolerance (or forcing terms), without history, with guesses in rotated
//   order, including the preconditioner's setup. The median is recorded.
// A lagged preconditioner is set up at the first Newton iteration of every `lag_steps`-th step, at no cost in between.
// Guesses receive the solution that advanced the trajectory. A guess of the user's that gives another x0 when asked again
// for a system is named in the task's message. If max |b| <= 1e-13 (rounding level), all guesses need
// zero iterations. A guess with a first residual that is not a number ends the task.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "runner/file/record.hpp"
#include "runner/specs/task_spec.hpp"
#include "solver/linear/linear_system.hpp"
#include "solver/step/forcing_terms.hpp"
#include "solver/step/projection.hpp"

namespace rodsweep {

/// Of the solves that advanced the rods: assembly, guesses and solves [s], and CG's share.
struct SolveEffort {
  double seconds = 0;
  int iterations = 0, products = 0;  ///< of CG; products with A include those of guesses
};

class MeasuredSolve : public LinearSolve {
 public:
  /// Fills the rows of /solves, their times and the per-task sums of `record`. All arguments must outlive this.
  MeasuredSolve(const Scene& scene, const TaskSpec& spec, TaskRecord& record);
  ~MeasuredSolve() override;

  SolveOutcome solve(const LinearSystem& system, const SolvePosition& at, double assemble_s,
                     VectorX& delta_lambda) override;

  /// Wall time of assembly and solves since the last call [s].
  double take_elapsed_s();

  /// The effort since the last call. Its time is 0 if an untimed solve advanced the rods (paired, reference "cg").
  SolveEffort take_effort();

  /// Call once, at the end of the task.
  void finish();

 private:
  struct Guess;
  struct RodSolvers;  // the solvers of one rod
  RodSolvers& solvers_for(const LinearSystem& system, int rod);
  SolveOutcome solve_directly(const LinearSystem& system, const SolvePosition& at, RodSolvers& solvers);
  SolveOutcome solve_reference(const LinearSystem& system, RodSolvers& solvers) const;
  SolveOutcome count(const LinearSystem& system, const SolvePosition& at, std::size_t row, RodSolvers& solvers);
  void time(const LinearSystem& system, const SolvePosition& at, std::size_t row, RodSolvers& solvers);
  void accept(const LinearSystem& system, const SolvePosition& at, std::size_t row, RodSolvers& solvers,
              const VectorX& solution);
  void add_effort(double assemble_s, RodSolvers& solvers);
  void add(CountSums& sums, std::size_t column, const std::vector<std::int16_t>& iterations, int used,
           int start_matvecs) const;

  const Scene& scene_;
  const TaskSpec& spec_;
  TaskRecord& record_;
  std::optional<DirectSolve> direct_;  ///< if spec.solves_directly()
  ForcingTerms forcing_;
  std::vector<Guess> guesses_;
  std::vector<std::unique_ptr<RodSolvers>> solvers_;  // created at a rod's first solve
  double elapsed_s_ = 0;
  SolveEffort effort_;
  std::string unusable_;  // label of a guess with an invalid first residual
  std::string unsteady_;  // label of the first guess with two answers for one system
};

// The columns of /solves that do not depend on the guess; they describe a linear system before its solve.

/// The row of a solve within its task: ordered by step, Newton iteration, rod. `rods`: number of rods in the scene.
std::size_t solve_row(const TaskSpec& spec, std::size_t rods, const SolvePosition& at);

/// Writes step, Newton iteration and rod.
void log_position(const SolvePosition& at, std::size_t row, TaskRecord& record);

/// Writes position, residual, gap and norm. `rod` is in the state from which the system was assembled.
void log_system(const LinearSystem& system, const Rod& rod, const SolvePosition& at, std::size_t row,
                TaskRecord& record);

}  // namespace rodsweep
