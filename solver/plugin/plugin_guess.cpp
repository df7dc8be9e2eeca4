#include "solver/plugin/plugin_guess.hpp"

namespace rodsweep {

PluginGuess::PluginGuess(const PluginSource& source, const Scene& scene)
    : scene_(scene), instance_(source, scene.rods.data(), static_cast<int>(scene.rods.size())) {
  if (!instance_.functions().propose) throw instance_.error("lacks propose");
}

rodsweep_system PluginGuess::view(const LinearSystem& system, const SolvePosition& at) const {
  return plugin_system(scene_.rods[static_cast<std::size_t>(at.rod)], system, at);
}

Proposal PluginGuess::propose(const LinearSystem& system, const SolvePosition& at, VectorX& x0) {
  const rodsweep_system seen = view(system, at);
  int products = 0;
  const bool nonzero = instance_.call(instance_.functions().propose, &seen, x0.data(), &products) > 0;
  if (!nonzero) x0.setZero();
  if (!x0.allFinite()) throw instance_.error("proposed a guess that is not finite");
  if (products < 0 || products > RODSWEEP_MOST_PRODUCTS)
    throw instance_.error("counted " + std::to_string(products) + " products with A; must be from 0 to " +
                          std::to_string(RODSWEEP_MOST_PRODUCTS));
  return {nonzero, products};
}

void PluginGuess::accept(const LinearSystem& system, const SolvePosition& at, const VectorX& solution) {
  const auto accept = instance_.functions().accept;
  if (!accept) return;
  const rodsweep_system seen = view(system, at);
  instance_.call(accept, &seen, solution.data());
}

void PluginGuess::accept_total(int rod, int step, const VectorX& total) {
  if (const auto accept_total = instance_.functions().accept_total)
    instance_.call(accept_total, rod, step, total.data());
}

}  // namespace rodsweep
