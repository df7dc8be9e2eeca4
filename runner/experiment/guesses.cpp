#include "runner/experiment/guesses.hpp"

#include <stdexcept>

#include "network/guess/coping_net_guess.hpp"
#include "network/guess/knn_guess.hpp"
#include "runner/experiment/models.hpp"
#include "runner/experiment/training_sets.hpp"
#include "solver/guess/regression_guess.hpp"
#include "solver/guess/subspace_guess.hpp"
#include "solver/guess/totals_guess.hpp"
#include "solver/step/time_step.hpp"

namespace rodsweep {

namespace {

/// `noise`: the relative error of the solutions that the guess will hear of.
std::unique_ptr<InitialGuess> make(const GuessSpec& guess, const TaskSpec& task, const Scene& scene, double noise) {
  using Kind = GuessSpec::Kind;
  const auto extrapolation = [&](int terms) {
    return std::make_unique<ExtrapolationGuess>(scene, task.time.newton_iterations, terms);
  };
  using Use = SubspaceGuess::Use;
  const auto subspace = [&](SubspaceGuess::Window window, Use use = Use::guess) {
    return std::make_unique<SubspaceGuess>(scene, task.time.newton_iterations, guess.size, window, use);
  };
  switch (guess.kind) {
    case Kind::zero: return std::make_unique<ZeroGuess>();
    case Kind::previous: return extrapolation(1);
    case Kind::linear: return extrapolation(2);
    case Kind::quadratic: return extrapolation(3);
    case Kind::fischer: return subspace(SubspaceGuess::Window::restarted);
    case Kind::subspace: return subspace(SubspaceGuess::Window::sliding);
    case Kind::deflation: return subspace(SubspaceGuess::Window::sliding, Use::guess_and_deflation);
    case Kind::regression:
      return std::make_unique<RegressionGuess>(scene, task.time.newton_iterations, guess.window, noise);
    case Kind::copingnet:
      return std::make_unique<CopingNetGuess>(shared_model(guess.model), scene, task.time.newton_iterations,
                                              FactorUse{guess.corrections, guess.factor_lag_steps, guess.stop_at});
    case Kind::knn:
      return std::make_unique<KnnGuess>(shared_knn_set(guess.data, guess.simulations, guess.knn_inputs), scene,
                                        constraint_dt(scene, task.time.step_s), guess.neighbours);
    case Kind::oracle: return std::make_unique<OracleGuess>(scene, guess.error, guess.error_kind, task.seed);
    case Kind::guarded:
      return std::make_unique<GuardedGuess>(scene, make(guess.inner.front(), task, scene, noise), guess.threshold);
    case Kind::totals:
      return std::make_unique<TotalsGuess>(scene, make(guess.inner.front(), task, scene, 0));  // Newton corrects them
    case Kind::first: return std::make_unique<FirstGuess>(make(guess.inner.front(), task, scene, noise));
  }
  throw std::logic_error("make_guess: unknown kind of guess \"" + guess.label + "\"");
}

}  // namespace

std::unique_ptr<InitialGuess> make_guess(const GuessSpec& guess, const TaskSpec& task, const Scene& scene) {
  const bool closed_loop = task.own_guess >= 0;
  return make(guess, task, scene, closed_loop ? task.solve.tolerance : 0);
}

}  // namespace rodsweep
