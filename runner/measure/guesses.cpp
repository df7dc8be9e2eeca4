#include "runner/measure/timed_guess.hpp"

#include <variant>

#include "network/guess/coping_net_guess.hpp"
#include "network/guess/knn_guess.hpp"
#include "runner/measure/shared_inputs.hpp"
#include "solver/guess/extrapolation_guess.hpp"
#include "solver/guess/oracle_guess.hpp"
#include "solver/guess/regression_guess.hpp"
#include "solver/guess/ritz_guess.hpp"
#include "solver/guess/subspace_guess.hpp"
#include "solver/guess/wrapped_guess.hpp"
#include "solver/plugin/plugin.hpp"

namespace rodsweep {
namespace {

/// Makes guesses for the rods of a task.
struct Maker {
  using Made = std::unique_ptr<InitialGuess>;
  const TaskSpec& task;
  const Scene& scene;
  double noise;  ///< relative error of the solutions passed to the guess
  int newton_iterations = task.time.newton_iterations;

  Made make(const GuessSpec& guess) const { return std::visit(*this, guess.kind); }
  Made subspace(int size, SubspaceGuess::Window window, SubspaceGuess::Use use = SubspaceGuess::Use::guess) const {
    return std::make_unique<SubspaceGuess>(scene, newton_iterations, size, window, use);
  }

  Made operator()(const guess::Zero&) const { return std::make_unique<ZeroGuess>(); }
  Made operator()(const guess::Extrapolation& g) const {
    return std::make_unique<ExtrapolationGuess>(scene, newton_iterations, g.terms);
  }
  Made operator()(const guess::Fischer& g) const { return subspace(g.size, SubspaceGuess::Window::restarted); }
  Made operator()(const guess::Subspace& g) const { return subspace(g.size, SubspaceGuess::Window::sliding); }
  Made operator()(const guess::Deflation& g) const {
    return subspace(g.size, SubspaceGuess::Window::sliding, SubspaceGuess::Use::guess_and_deflation);
  }
  Made operator()(const guess::Regression& g) const {
    return std::make_unique<RegressionGuess>(scene, newton_iterations, g.size, noise);
  }
  Made operator()(const guess::CopingNet& g) const {
    return std::make_unique<CopingNetGuess>(shared_model(g.model), scene, newton_iterations,
                                            FactorUse{g.corrections, g.lag_steps, g.stop_at});
  }
  Made operator()(const guess::Knn& g) const {
    return std::make_unique<KnnGuess>(shared_knn_set(g.data, g.simulations, g.inputs), scene, g.neighbours);
  }
  Made operator()(const guess::Plugin& g) const { return std::make_unique<PluginGuess>(plugin_source(g), scene); }
  Made operator()(const guess::Python& g) const {
    return std::make_unique<PluginGuess>(plugin_source(g, PythonClass::guess), scene);
  }
  Made operator()(const guess::Oracle& g) const {
    return std::make_unique<OracleGuess>(scene, g.error, g.kind, task.seed);
  }
  Made operator()(const guess::Guarded& g) const {
    return std::make_unique<GuardedGuess>(scene, make(*g.guess), g.threshold);
  }
  Made operator()(const guess::Totals& g) const {
    const Maker exact{task, scene, 0};  // later Newton iterations correct the sums
    return std::make_unique<TotalsGuess>(scene, exact.make(*g.guess));
  }
  Made operator()(const guess::First& g) const { return std::make_unique<FirstGuess>(make(*g.guess)); }
  Made operator()(const guess::Ritz& g) const {
    return std::make_unique<RitzGuess>(scene, make(*g.guess), g.size, g.collected, g.lag_steps);
  }
};

}  // namespace

std::unique_ptr<InitialGuess> make_guess(const GuessSpec& guess, const TaskSpec& task, const Scene& scene) {
  const bool closed_loop = task.own_guess >= 0;
  return Maker{task, scene, closed_loop ? task.solve.tolerance : 0}.make(guess);
}

}  // namespace rodsweep
