#include "runner/experiment/measured_solve.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "runner/experiment/guesses.hpp"
#include "runner/job/plan.hpp"
#include "solver/stopwatch.hpp"

namespace rodsweep {
namespace {

constexpr double rounding_level = 1e-13;  // of b, whose entries are dimensionless and of order one

}  // namespace

struct MeasuredSolve::Guess {
  std::size_t column;  ///< on the file's guess axis
  std::unique_ptr<InitialGuess> guess;
};

/// Everything of one rod that is sized once.
struct MeasuredSolve::RodSolvers {
  struct PerGuess {
    ConjugateGradient timed;
    VectorX x0;
    bool nonzero = false;
    double guess_s = 0, cg_s = 0;
    std::vector<std::int16_t> iterations;
    CgReport tight, advanced;
  };
  ConjugateGradient tight;
  std::vector<PerGuess> guesses;
  VectorX exact, x, residual;

  RodSolvers(const BlockMatrix& a, const CgSettings& settings, std::size_t guess_count)
      : tight(a, settings), exact(VectorX::Zero(a.unknowns())), x(exact), residual(exact) {
    tight.record_history(true);
    for (std::size_t g = 0; g < guess_count; ++g)
      guesses.push_back({ConjugateGradient(a, settings),
                         exact,
                         false,
                         0,
                         0,
                         std::vector<std::int16_t>(tolerance_ladder().size(), 0),
                         {},
                         {}});
  }
};

MeasuredSolve::MeasuredSolve(const Scene& scene, const TaskSpec& spec, TaskRecord& record)
    : spec_(spec), record_(record), direct_(scene), solvers_(scene.rods.size()) {
  const bool one = spec.own_guess >= 0;
  for (std::size_t g = 0; g < spec.guesses.size(); ++g)
    if (!one || static_cast<int>(g) == spec.own_guess)
      guesses_.push_back({g, make_guess(spec.guesses[g], spec, scene)});
  const std::size_t tolerances = tolerance_ladder().size();
  for (const Guess& guess : guesses_)
    for (std::size_t t = 0; t < tolerances; ++t) {
      const std::size_t at = guess.column * tolerances + t;
      record_.iterations_sum[at] = record_.iterations_sum_all[at] = 0;
      record_.unreached[at] = record_.unreached_all[at] = 0;
    }
}

MeasuredSolve::~MeasuredSolve() = default;

MeasuredSolve::RodSolvers& MeasuredSolve::solvers_for(const LinearSystem& system, int rod) {
  std::unique_ptr<RodSolvers>& solvers = solvers_[static_cast<std::size_t>(rod)];
  if (!solvers) {
    const CgSettings settings{spec_.solve.preconditioner, spec_.solve.norm, spec_.solve.max_iterations};
    solvers = std::make_unique<RodSolvers>(system.matrix(), settings, guesses_.size());
  }
  return *solvers;
}

SolveOutcome MeasuredSolve::solve(const LinearSystem& system, const SolvePosition& at, double assemble_s,
                                  VectorX& delta_lambda) {
  const Stopwatch whole;
  elapsed_s_ += assemble_s;
  RodSolvers& solvers = solvers_for(system, at.rod);
  const BlockMatrix& a = system.matrix();
  const VectorX& b = system.rhs();
  const std::size_t columns = spec_.guesses.size(), tolerances = tolerance_ladder().size();
  const std::size_t row = (static_cast<std::size_t>(at.step) * static_cast<std::size_t>(spec_.time.newton_iterations) +
                           static_cast<std::size_t>(at.newton)) *
                              solvers_.size() +
                          static_cast<std::size_t>(at.rod);
  const bool rounding = system.newton_residual() <= rounding_level;

  const Stopwatch direct_watch;
  const SolveOutcome direct = direct_.solve(system, at, 0, solvers.exact);
  const double direct_s = direct_watch.seconds();
  if (spec_.record.solves) {
    record_.step[row] = at.step;
    record_.newton[row] = static_cast<std::int16_t>(at.newton);
    record_.rod[row] = static_cast<std::int16_t>(at.rod);
    record_.newton_residual[row] = system.newton_residual();
    record_.rhs_norm[row] = b.norm();
    record_.assemble_s[row] = static_cast<float>(assemble_s);
    record_.direct_s[row] = static_cast<float>(direct_s);
  }
  delta_lambda = solvers.exact;
  if (direct != SolveOutcome::converged || guesses_.empty()) {
    elapsed_s_ += whole.seconds();
    return direct;
  }

  // Counted: one tight solve for each guess.
  solvers.tight.matrix_changed();
  const double reference = solvers.tight.norm_of(b);
  for (std::size_t g = 0; g < guesses_.size(); ++g) {
    RodSolvers::PerGuess& own = solvers.guesses[g];
    const Stopwatch watch;
    own.nonzero = guesses_[g].guess->propose(system, at, own.x0);
    own.guess_s = watch.seconds();
    const std::size_t entry = row * columns + guesses_[g].column;
    if (rounding) {
      own.tight = {SolveOutcome::zero_rhs, 0};
      std::fill(own.iterations.begin(), own.iterations.end(), std::int16_t{0});
    } else {
      solvers.x = own.x0;
      own.tight = solvers.tight.solve(b, solvers.x, own.nonzero, tolerance_ladder().back(), reference);
      iterations_to(solvers.tight.history(), reference, tolerance_ladder(), own.iterations.data());
    }
    count(g, at, own.iterations.data(), own.tight.iterations);
    if (!spec_.record.solves) continue;
    record_.reason[entry] = static_cast<std::int8_t>(own.tight.outcome);
    std::copy(own.iterations.begin(), own.iterations.end(),
              record_.iterations.begin() + static_cast<std::ptrdiff_t>(entry * tolerances));
    if (rounding) continue;
    a.multiply(solvers.x.data(), solvers.residual.data());
    record_.initial_residual[entry] = solvers.tight.history().front() / reference;
    record_.final_residual[entry] = (b - solvers.residual).norm() / b.norm();
  }

  // Timed: one solve each to the job's tolerance, in an order that rotates from system to system.
  for (std::size_t k = 0; k < guesses_.size(); ++k) {
    RodSolvers::PerGuess& own = solvers.guesses[(k + row) % guesses_.size()];
    solvers.x = own.x0;
    own.timed.matrix_changed();
    const Stopwatch watch;
    own.advanced = rounding ? CgReport{SolveOutcome::converged, 0}
                            : own.timed.solve(b, solvers.x, own.nonzero, spec_.solve.tolerance, reference);
    own.cg_s = watch.seconds();
  }

  SolveOutcome outcome = direct;
  if (spec_.own_guess >= 0 && !rounding) {
    delta_lambda = solvers.x;
    outcome = solvers.guesses.front().advanced.outcome;
  }
  for (std::size_t g = 0; g < guesses_.size(); ++g) {
    const Stopwatch watch;
    guesses_[g].guess->accept(at, delta_lambda);
    if (!spec_.record.solves) continue;
    const std::size_t entry = row * columns + guesses_[g].column;
    record_.guess_s[entry] = static_cast<float>(solvers.guesses[g].guess_s + watch.seconds());
    record_.cg_s[entry] = static_cast<float>(solvers.guesses[g].cg_s);
  }
  elapsed_s_ += whole.seconds();
  return outcome;
}

void MeasuredSolve::count(std::size_t guess, const SolvePosition& at, const std::int16_t* iterations, int used) {
  const std::size_t tolerances = tolerance_ladder().size();
  for (std::size_t t = 0; t < tolerances; ++t) {
    const std::size_t to = guesses_[guess].column * tolerances + t;
    const bool reached = iterations[t] >= 0;
    const int spent = reached ? iterations[t] : used;
    record_.iterations_sum_all[to] += spent;
    record_.unreached_all[to] += !reached;
    if (at.newton > 0) continue;
    record_.iterations_sum[to] += spent;
    record_.unreached[to] += !reached;
  }
}

double MeasuredSolve::take_elapsed_s() { return std::exchange(elapsed_s_, 0); }

void MeasuredSolve::finish() {
  const std::size_t tolerances = tolerance_ladder().size();
  const auto zero = std::find_if(guesses_.begin(), guesses_.end(), [this](const Guess& g) {
    return spec_.guesses[g.column].kind == GuessSpec::Kind::zero;
  });
  if (zero == guesses_.end()) return;
  const auto ratio = [](std::int64_t sum, std::int64_t of_zero) {
    return of_zero > 0 ? static_cast<double>(sum) / static_cast<double>(of_zero)
                       : std::numeric_limits<double>::quiet_NaN();
  };
  for (const Guess& guess : guesses_)
    for (std::size_t t = 0; t < tolerances; ++t) {
      const std::size_t to = guess.column * tolerances + t, of = zero->column * tolerances + t;
      record_.cg_ratio[to] = ratio(record_.iterations_sum[to], record_.iterations_sum[of]);
      record_.cg_ratio_all[to] = ratio(record_.iterations_sum_all[to], record_.iterations_sum_all[of]);
    }
}

}  // namespace rodsweep
