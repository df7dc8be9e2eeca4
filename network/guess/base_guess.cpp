#include "network/guess/base_guess.hpp"

#include "solver/guess/extrapolation_guess.hpp"
#include "solver/guess/regression_guess.hpp"
#include "solver/guess/subspace_guess.hpp"

namespace rodsweep {

std::unique_ptr<InitialGuess> base_guess(const CopingNetSettings& settings, const Scene& scene, int newton_iterations) {
  switch (settings.base) {
    case BaseGuess::none: return std::make_unique<ZeroGuess>();
    case BaseGuess::extrapolation: return std::make_unique<ExtrapolationGuess>(scene, newton_iterations, 3);
    case BaseGuess::regression:
      return std::make_unique<RegressionGuess>(scene, newton_iterations, settings.base_size, 0);
    case BaseGuess::subspace: break;
  }
  return std::make_unique<SubspaceGuess>(scene, newton_iterations, settings.base_size, SubspaceGuess::Window::sliding);
}

}  // namespace rodsweep
