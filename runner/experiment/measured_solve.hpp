// The linear solve of an experiment: solves each system directly and with CG from every guess under test, counts,
// times, and lets one of the solutions advance the trajectory. With the reference "cg" nothing is solved directly: in
// place of the direct solution stands that of CG from zero, which the zero guess's untimed solve finds anyway.
//
// Per system and guess: one untimed solve to the tightest tolerance of the ladder, in each norm, whose residual history
// gives the iterations to every tolerance; `timing_repeats` timed solves to the job's tolerance (or as its forcing
// terms ask), without history, the guesses in rotated order, the preconditioner's set-up included; the median counts. A
// lagged preconditioner is set up at the first Newton iteration of every `lag_steps`-th step, and costs nothing in
// between. Guesses hear of the solution that advanced the trajectory. Right-hand sides at rounding level (max |b| <=
// 1e-13) count as solved: zero iterations for every guess. A guess that no solve can start from (its first residual is
// not a number) ends the task.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "runner/file/record.hpp"
#include "runner/job/task.hpp"
#include "solver/guess/initial_guess.hpp"
#include "solver/step/forcing_terms.hpp"
#include "solver/step/projection.hpp"

namespace rodsweep {

/// cg_ratio from the sums, of all guesses that have any.
void set_cg_ratios(const TaskSpec& spec, TaskRecord& record);

class MeasuredSolve : public LinearSolve {
 public:
  /// Fills the rows of /solves, their timings and the per-task sums of `record`. All arguments must outlive this.
  MeasuredSolve(const Scene& scene, const TaskSpec& spec, TaskRecord& record);
  ~MeasuredSolve() override;

  SolveOutcome solve(const LinearSystem& system, const SolvePosition& at, double assemble_s,
                     VectorX& delta_lambda) override;

  /// Wall time spent in assembly and in here since the last call [s].
  double take_elapsed_s();

  /// To be called once, at the end of the task.
  void finish();

 private:
  struct Guess;       // one guess under test
  struct RodSolvers;  // the solvers of one rod
  RodSolvers& solvers_for(const LinearSystem& system, int rod);
  SolveOutcome solve_directly(const LinearSystem& system, const SolvePosition& at, RodSolvers& solvers);
  SolveOutcome solve_reference(const LinearSystem& system, RodSolvers& solvers) const;
  SolveOutcome count(const LinearSystem& system, const SolvePosition& at, std::size_t row, RodSolvers& solvers);
  void time(const LinearSystem& system, const SolvePosition& at, std::size_t row, RodSolvers& solvers);
  void accept(const SolvePosition& at, std::size_t row, RodSolvers& solvers, const VectorX& solution);
  void add(CountSums& sums, std::size_t column, const std::vector<std::int16_t>& iterations, int used,
           int start_matvecs) const;

  const Scene& scene_;
  const TaskSpec& spec_;
  TaskRecord& record_;
  std::optional<DirectSolve> direct_;  ///< unless nothing is solved directly
  ForcingTerms forcing_;
  std::vector<Guess> guesses_;
  std::vector<std::unique_ptr<RodSolvers>> solvers_;  // made at a rod's first solve
  double elapsed_s_ = 0;
  std::string unusable_;  // label of the guess that no solve can start from
};

}  // namespace rodsweep
