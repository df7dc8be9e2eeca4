#include "solver/guess/extrapolation_guess.hpp"

namespace rodsweep {

ExtrapolationGuess::ExtrapolationGuess(const Scene& scene, int newton_iterations, int terms)
    : HistoryGuess(newton_iterations) {
  for (const VectorX& none : unknowns_of(scene)) add_rod({{terms}, std::vector<VectorX>(at(terms), none)});
}

Proposal ExtrapolationGuess::propose(const LinearSystem&, const SolvePosition& at, VectorX& x0) {
  const LastSolutions& h = history(at);
  const auto back = [&](int steps) -> const VectorX& { return h.solutions[rodsweep::at(h.place(steps))]; };
  const int known = h.usable(at.step);
  switch (known) {
    case 0: x0.setZero(); break;
    case 1: x0 = back(0); break;
    case 2: x0 = 2 * back(0) - back(1); break;
    default: x0 = 3 * back(0) - 3 * back(1) + back(2);
  }
  return {known > 0, 0};
}

void ExtrapolationGuess::accept(const LinearSystem&, const SolvePosition& at, const VectorX& solution) {
  LastSolutions& h = history(at);
  h.add(at.step);
  h.keep(solution);
}

}  // namespace rodsweep
