#include "runner/measure/measured_solve.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "network/guess/factor_preconditioner.hpp"
#include "runner/measure/shared_inputs.hpp"
#include "runner/measure/timed_guess.hpp"
#include "runner/plan/plan.hpp"
#include "solver/cg/cg_solver.hpp"
#include "solver/linear/solve_outcome.hpp"
#include "solver/numbers/narrow.hpp"
#include "solver/plugin/plugin.hpp"
#include "solver/step/observables.hpp"
#include "solver/step/stopwatch.hpp"

namespace rodsweep {
namespace {

bool is_zero(const GuessSpec& guess) { return std::holds_alternative<guess::Zero>(guess.kind); }

bool is_of_the_user(const GuessSpec& guess) {
  return find_guess<guess::Plugin>(guess) || find_guess<guess::Python>(guess);
}

bool is_solved(SolveOutcome outcome) { return outcome == SolveOutcome::converged || outcome == SolveOutcome::zero_rhs; }

/// A condensed system has only one norm.
bool has_other_norm(const TaskSpec& spec) {
  return spec.output.other_norm && spec.solve.preconditioner != Preconditioner::condensed;
}

}  // namespace

struct MeasuredSolve::Guess {
  std::size_t column;  ///< index on the file's guess axis
  bool is_zero;
  bool is_of_the_user;  ///< its proposals are compared
  TimedGuess guess;
};

/// The solvers and buffers of one rod, allocated once.
struct MeasuredSolve::RodSolvers {
  struct PerGuess {
    std::unique_ptr<CgSolver> timed;
    VectorX x0, first_x0;      ///< the latest proposal; the first one for this system, if compared
    Proposal proposal;         ///< of x0
    std::vector<double> cg_s;  ///< [repeat]
    CgReport advanced;
  };
  std::unique_ptr<CgSolver> tight;
  std::unique_ptr<CgSolver> tight_other;  ///< in the other norm; may be null
  std::vector<PerGuess> guesses;
  std::vector<double> direct_s;  ///< [repeat]
  std::vector<std::int16_t> iterations, iterations_other;
  double reference = 0;  ///< norm of b
  bool renewed = false;  ///< the preconditioners were set up for this system
  VectorX exact, x, residual;
  std::optional<SolveOutcome> exact_outcome;  ///< of `exact`; none until it is computed for this system

  RodSolvers(const Rod& rod, int index, const LinearSystem& system, const TaskSpec& spec, std::size_t guess_count)
      : tight(make_cg(rod, system, settings(rod, index, system, spec, spec.solve.norm))),
        direct_s(static_cast<std::size_t>(spec.solve.timing_repeats)),
        iterations(tolerance_ladder().size()),
        iterations_other(iterations),
        exact(VectorX::Zero(system.matrix().unknowns())),
        x(exact),
        residual(exact) {
    tight->keep_history(true);
    if (has_other_norm(spec)) {
      const Norm other = spec.solve.norm == Norm::natural ? Norm::true_residual : Norm::natural;
      tight_other = make_cg(rod, system, settings(rod, index, system, spec, other));
      tight_other->keep_history(true);
    }
    for (std::size_t g = 0; g < guess_count; ++g)
      guesses.push_back(
          {make_cg(rod, system, settings(rod, index, system, spec, spec.solve.norm)), exact, {}, {}, direct_s, {}});
  }

  static CgSettings settings(const Rod& rod, int index, const LinearSystem& system, const TaskSpec& spec, Norm norm) {
    CgSettings made{spec.solve.preconditioner, norm, spec.solve.max_iterations, spec.solve.fill_levels};
    const auto plugin = [&](const PluginSource& source) {
      made.make_given = [&rod, index, &system, source] {
        return std::make_unique<PluginPreconditioner>(source, rod, index, system);
      };
    };
    if (spec.solve.preconditioner == Preconditioner::learned)
      made.make_given = [&rod, &system, model = shared_model(spec.solve.learned->model)] {
        return std::make_unique<FactorPreconditioner>(model, rod, system);
      };
    if (spec.solve.preconditioner == Preconditioner::plugin) plugin(plugin_source(*spec.solve.plugin));
    if (spec.solve.preconditioner == Preconditioner::python)
      plugin(plugin_source(*spec.solve.python, PythonClass::preconditioner));
    return made;
  }

  void renew_preconditioners() {
    tight->matrix_changed();
    if (tight_other) tight_other->matrix_changed();
    for (PerGuess& guess : guesses) guess.timed->matrix_changed();
  }
};

MeasuredSolve::MeasuredSolve(const Scene& scene, const TaskSpec& spec, TaskRecord& record)
    : scene_(scene),
      spec_(spec),
      record_(record),
      forcing_(static_cast<int>(scene.rods.size()), spec.solve.tolerance, spec.time.newton_tolerance),
      solvers_(scene.rods.size()) {
  if (spec.solves_directly()) direct_.emplace(scene);
  for (std::size_t g = 0; g < spec.guesses.size(); ++g)
    if (spec.own_guess < 0 || static_cast<int>(g) == spec.own_guess)
      guesses_.push_back({g, is_zero(spec.guesses[g]), is_of_the_user(spec.guesses[g]),
                          TimedGuess(make_guess(spec.guesses[g], spec, scene))});
  for (const Guess& guess : guesses_) {
    record_.timing.solves_timed(0, guess.column) = 0;
    record_.timing.solves_missed(0, guess.column) = 0;
    record_.timing.solves_with_network(0, guess.column) = 0;
  }
  if (!spec.output.counts) return;
  const std::size_t tolerances = tolerance_ladder().size();
  for (const Guess& guess : guesses_) {
    const auto reset = [&](auto& sums) { std::fill_n(&sums(0, guess.column), tolerances, 0); };
    for (CountSums* sums : {&record_.tasks.counted, &record_.tasks.counted_all}) {
      reset(sums->iterations);
      reset(sums->matvecs);
      reset(sums->unreached);
    }
    if (!has_other_norm(spec)) continue;
    reset(record_.tasks.counted_other_norm.iterations);
    reset(record_.tasks.counted_other_norm.unreached);
  }
}

MeasuredSolve::~MeasuredSolve() = default;

MeasuredSolve::RodSolvers& MeasuredSolve::solvers_for(const LinearSystem& system, int rod) {
  std::unique_ptr<RodSolvers>& solvers = solvers_[static_cast<std::size_t>(rod)];
  if (!solvers)
    solvers =
        std::make_unique<RodSolvers>(scene_.rods[static_cast<std::size_t>(rod)], rod, system, spec_, guesses_.size());
  return *solvers;
}

SolveOutcome MeasuredSolve::solve(const LinearSystem& system, const SolvePosition& at, double assemble_s,
                                  VectorX& delta_lambda) {
  const Stopwatch whole;
  elapsed_s_ += assemble_s;
  RodSolvers& solvers = solvers_for(system, at.rod);
  const std::size_t row = solve_row(spec_, solvers_.size(), at);

  solvers.exact_outcome.reset();
  SolveOutcome outcome = std::isfinite(system.largest_rhs()) ? SolveOutcome::converged : SolveOutcome::not_a_number;
  if (direct_) {
    outcome = solve_directly(system, at, solvers);
    if (spec_.own_guess < 0) effort_.seconds += assemble_s + median(solvers.direct_s);
  }
  if (spec_.output.solves) {
    log_system(system, scene_.rods[static_cast<std::size_t>(at.rod)], at, row, record_);
    record_.timing.assemble_s[row] = static_cast<float>(assemble_s);
    if (direct_) record_.timing.direct_s[row] = static_cast<float>(median(solvers.direct_s));
  }
  if (outcome == SolveOutcome::converged && !guesses_.empty()) {
    const int kept = spec_.solve.kept_steps();
    solvers.renewed = kept == 0 || (at.newton == 0 && at.step % kept == 0);
    if (solvers.renewed) solvers.renew_preconditioners();
    solvers.reference = solvers.tight->norm_of(system.rhs());
    for (Guess& guess : guesses_) guess.guess.prepare(at);
    if (spec_.output.counts) outcome = count(system, at, row, solvers);
  }
  if (outcome == SolveOutcome::converged && !direct_) outcome = solve_reference(system, solvers);
  delta_lambda = solvers.exact;
  if ((outcome == SolveOutcome::converged || outcome == SolveOutcome::iteration_limit) && !guesses_.empty()) {
    time(system, at, row, solvers);
    if (spec_.own_guess >= 0) {
      if (system.largest_rhs() > rounding_level)
        delta_lambda = solvers.x;
      else
        delta_lambda.setZero();
      outcome = solvers.guesses.front().advanced.outcome;
    }
    accept(system, at, row, solvers, delta_lambda);
    if (spec_.own_guess >= 0) add_effort(assemble_s, solvers);
  }
  elapsed_s_ += whole.seconds();
  return outcome;
}

SolveOutcome MeasuredSolve::solve_directly(const LinearSystem& system, const SolvePosition& at, RodSolvers& solvers) {
  SolveOutcome outcome = SolveOutcome::not_run;
  for (double& seconds : solvers.direct_s) {
    const Stopwatch watch;
    outcome = direct_->solve(system, at, 0, solvers.exact);
    seconds = watch.seconds();
  }
  return outcome;
}

/// Solves with CG from zero to the tightest tolerance, unless the zero guess did so or no reference is needed.
SolveOutcome MeasuredSolve::solve_reference(const LinearSystem& system, RodSolvers& solvers) const {
  if (solvers.exact_outcome) return *solvers.exact_outcome;
  solvers.exact.setZero();
  if (spec_.own_guess >= 0 || system.largest_rhs() <= rounding_level) return SolveOutcome::converged;
  return solvers.tight->solve(system.rhs(), solvers.exact, CgStart(false), tolerance_ladder().back(), solvers.reference)
      .outcome;
}

/// One untimed tight solve per guess and norm. Returns `converged` unless a guess has an invalid first residual.
SolveOutcome MeasuredSolve::count(const LinearSystem& system, const SolvePosition& at, std::size_t row,
                                  RodSolvers& solvers) {
  const VectorX& b = system.rhs();
  const std::vector<double>& ladder = tolerance_ladder();
  const bool rounding = system.largest_rhs() <= rounding_level;
  const double reference_other = solvers.tight_other ? solvers.tight_other->norm_of(b) : 0;
  SolveOutcome failure = SolveOutcome::not_run;
  for (std::size_t g = 0; g < guesses_.size(); ++g) {
    RodSolvers::PerGuess& own = solvers.guesses[g];
    own.proposal = guesses_[g].guess.propose(system, at, own.x0);
    if (guesses_[g].is_of_the_user) own.first_x0 = own.x0;
    const int start = own.proposal.start_products();
    const std::size_t column = guesses_[g].column;
    const auto tight_solve = [&](CgSolver& cg, double reference, std::vector<std::int16_t>& iterations) {
      if (rounding) {
        std::fill(iterations.begin(), iterations.end(), std::int16_t{0});
        return CgReport{SolveOutcome::zero_rhs};
      }
      solvers.x = own.x0;
      const CgReport report =
          cg.solve(b, solvers.x, own.proposal.start(), ladder.back(), reference, guesses_[g].guess.deflation());
      if (cg.history().empty()) failure = report.outcome;  // the first residual was not a number
      iterations_to(cg.history(), reference, ladder, iterations.data());
      return report;
    };
    CgReport other;
    if (solvers.tight_other) other = tight_solve(*solvers.tight_other, reference_other, solvers.iterations_other);
    const CgReport report = tight_solve(*solvers.tight, solvers.reference, solvers.iterations);
    if (failure != SolveOutcome::not_run) {
      if (spec_.output.solves) record_.solves.outcome(row, column) = static_cast<std::int8_t>(failure);
      unusable_ = spec_.guesses[column].label;
      return failure;
    }
    if (!direct_ && guesses_[g].is_zero && !rounding) {
      solvers.exact = solvers.x;
      solvers.exact_outcome = report.outcome;
    }
    if (solvers.tight_other && at.newton == 0)
      add(record_.tasks.counted_other_norm, column, solvers.iterations_other, other.iterations, start);
    add(record_.tasks.counted_all, column, solvers.iterations, report.iterations, start);
    if (at.newton == 0) add(record_.tasks.counted, column, solvers.iterations, report.iterations, start);

    if (!spec_.output.solves) continue;
    record_.solves.outcome(row, column) = static_cast<std::int8_t>(report.outcome);
    std::copy(solvers.iterations.begin(), solvers.iterations.end(), &record_.solves.iterations(row, column));
    if (rounding) continue;
    system.multiply(solvers.x.data(), solvers.residual.data());
    record_.solves.initial_residual(row, column) = solvers.tight->history().front() / solvers.reference;
    record_.solves.final_residual(row, column) = (b - solvers.residual).norm() / b.norm();
  }
  return SolveOutcome::converged;
}

/// Timed solves to the job's tolerance. The order of the guesses rotates with each system and repeat.
void MeasuredSolve::time(const LinearSystem& system, const SolvePosition& at, std::size_t row, RodSolvers& solvers) {
  const bool rounding = system.largest_rhs() <= rounding_level;
  const double tolerance = spec_.solve.forcing == Forcing::fixed
                               ? spec_.solve.tolerance
                               : forcing_.next(at.rod, at.newton, solvers.reference, system.largest_rhs());
  for (std::size_t repeat = 0; repeat < solvers.direct_s.size(); ++repeat)
    for (std::size_t k = 0; k < guesses_.size(); ++k) {
      const std::size_t g = (k + row + repeat) % guesses_.size();
      RodSolvers::PerGuess& own = solvers.guesses[g];
      const Proposal again = guesses_[g].guess.propose_timed(system, at, own.x0);
      if (spec_.output.counts && guesses_[g].is_of_the_user && unsteady_.empty() &&
          (own.x0 != own.first_x0 || again.start_products() != own.proposal.start_products()))
        unsteady_ = spec_.guesses[guesses_[g].column].label;
      own.proposal = again;
      solvers.x = own.x0;
      if (repeat > 0 && solvers.renewed) own.timed->matrix_changed();
      const Stopwatch watch;
      own.advanced = rounding ? CgReport{SolveOutcome::converged}
                              : own.timed->solve(system.rhs(), solvers.x, own.proposal.start(), tolerance,
                                                 solvers.reference, guesses_[g].guess.deflation());
      own.cg_s[repeat] = watch.seconds();
    }
}

/// Passes the solution that advances the rod to the guesses, and stores the times; those of `accept` are counted.
void MeasuredSolve::accept(const LinearSystem& system, const SolvePosition& at, std::size_t row, RodSolvers& solvers,
                           const VectorX& solution) {
  const bool new_network = solvers.renewed && spec_.solve.preconditioner == Preconditioner::learned;
  for (std::size_t g = 0; g < guesses_.size(); ++g) {
    RodSolvers::PerGuess& own = solvers.guesses[g];
    const std::size_t column = guesses_[g].column;
    guesses_[g].guess.accept(system, at, solution);
    ++record_.timing.solves_timed(0, column);
    record_.timing.solves_missed(0, column) += !is_solved(own.advanced.outcome);
    record_.timing.solves_with_network(0, column) += own.proposal.with_network || new_network;
    if (!spec_.output.solves) continue;
    record_.solves.start_matvecs(row, column) = narrow<std::int16_t>(own.proposal.start_products());
    record_.solves.renewed(row, column) =
        own.proposal.renewed || (spec_.solve.kept_steps() > 0 && solvers.renewed) ? 1 : 0;
    record_.timing.guess_s(row, column) = static_cast<float>(guesses_[g].guess.seconds());
    record_.timing.cg_s(row, column) = static_cast<float>(median(own.cg_s));
  }
}

void MeasuredSolve::add_effort(double assemble_s, RodSolvers& solvers) {
  RodSolvers::PerGuess& own = solvers.guesses.front();
  effort_.seconds += assemble_s + guesses_.front().guess.seconds() + median(own.cg_s);
  effort_.iterations += own.advanced.iterations;
  effort_.products += own.advanced.products + own.proposal.products;
}

void MeasuredSolve::add(CountSums& sums, std::size_t column, const std::vector<std::int16_t>& iterations, int used,
                        int start_matvecs) const {
  for (std::size_t t = 0; t < iterations.size(); ++t) {
    const bool reached = iterations[t] >= 0;
    const int spent = reached ? iterations[t] : used;
    sums.iterations(0, column, t) += spent;
    sums.unreached(0, column, t) += !reached;
    if (!sums.matvecs.empty()) sums.matvecs(0, column, t) += spent + start_matvecs;
  }
}

SolveEffort MeasuredSolve::take_effort() { return std::exchange(effort_, {}); }

double MeasuredSolve::take_elapsed_s() { return std::exchange(elapsed_s_, 0); }

/// Sets cg_ratio from the sums, for all guesses that were tried.
static void set_cg_ratios(const TaskSpec& spec, TaskRecord& record) {
  const auto zero =
      static_cast<std::size_t>(std::find_if(spec.guesses.begin(), spec.guesses.end(), is_zero) - spec.guesses.begin());
  if (zero == spec.guesses.size()) return;
  const std::size_t tolerances = tolerance_ladder().size();
  for (CountSums* sums : {&record.tasks.counted, &record.tasks.counted_all, &record.tasks.counted_other_norm})
    for (std::size_t g = 0; g < spec.guesses.size(); ++g)
      for (std::size_t t = 0; t < tolerances; ++t) {
        const std::int64_t own = sums->iterations(0, g, t), of_zero = sums->iterations(0, zero, t);
        if (own >= 0 && of_zero > 0)  // negative: not tried in this task
          sums->cg_ratio(0, g, t) = static_cast<double>(own) / static_cast<double>(of_zero);
      }
}

void MeasuredSolve::finish() {
  set_cg_ratios(spec_, record_);
  if (!unusable_.empty()) record_.message += ": it cannot start from the guess \"" + unusable_ + "\"";
  if (unsteady_.empty()) return;
  if (!record_.message.empty()) record_.message += "; ";
  record_.message += "the guess \"" + unsteady_ +
                     "\" gave two different answers for the same system: its counts and times are not of one guess";
}

std::size_t solve_row(const TaskSpec& spec, std::size_t rods, const SolvePosition& at) {
  const auto newton_iterations = static_cast<std::size_t>(spec.time.newton_iterations);
  const std::size_t iteration =
      static_cast<std::size_t>(at.step) * newton_iterations + static_cast<std::size_t>(at.newton);
  return iteration * rods + static_cast<std::size_t>(at.rod);
}

void log_position(const SolvePosition& at, std::size_t row, TaskRecord& record) {
  record.solves.step[row] = at.step;
  record.solves.newton[row] = static_cast<std::int16_t>(at.newton);
  record.solves.rod[row] = narrow<std::int16_t>(at.rod);
}

void log_system(const LinearSystem& system, const Rod& rod, const SolvePosition& at, std::size_t row,
                TaskRecord& record) {
  log_position(at, row, record);
  record.solves.newton_residual[row] = system.newton_residual();
  record.solves.joint_gap[row] = joint_gap(rod);
  record.solves.rhs_norm[row] = system.rhs().norm();
}

}  // namespace rodsweep
