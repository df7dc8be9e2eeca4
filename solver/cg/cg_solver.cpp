#include "solver/cg/cg_solver.hpp"

#include <algorithm>
#include <limits>

#include "solver/cg/condensed_cg.hpp"
#include "solver/cg/conjugate_gradient.hpp"

namespace rodsweep {

std::unique_ptr<CgSolver> make_cg(const Rod& rod, const LinearSystem& system, const CgSettings& settings) {
  if (settings.preconditioner == Preconditioner::condensed) return std::make_unique<CondensedCg>(rod, system, settings);
  return std::make_unique<ConjugateGradient>(system, settings);
}

int iteration_limit(const CgSettings& settings, int unknowns) {
  if (settings.max_iterations > 0) return settings.max_iterations;
  return std::min(10 * unknowns, int{std::numeric_limits<std::int16_t>::max()});
}

void iterations_to(const std::vector<double>& history, double reference, const std::vector<double>& tolerances,
                   std::int16_t* out) {
  for (std::size_t t = 0; t < tolerances.size(); ++t) {
    out[t] = -1;
    for (std::size_t i = 0; i < history.size() && out[t] < 0; ++i)
      if (history[i] <= tolerances[t] * reference) out[t] = static_cast<std::int16_t>(i);
  }
}

}  // namespace rodsweep
