#include "solver/plugin/plugin_guess.hpp"

#include <algorithm>

namespace rodsweep {

PluginGuess::PluginGuess(const PluginSource& source, const Scene& scene)
    : scene_(scene), instance_(source, scene.rods.data(), static_cast<int>(scene.rods.size())) {
  if (!instance_.functions().propose) throw instance_.error("lacks propose");
}

Proposal PluginGuess::propose(const LinearSystem& system, const SolvePosition& at, VectorX& x0) {
  system_ = plugin_system(scene_.rods[static_cast<std::size_t>(at.rod)], system, at);
  int products = 0;
  const bool nonzero = instance_.call(instance_.functions().propose, &system_, x0.data(), &products) > 0;
  if (!nonzero) x0.setZero();
  if (!x0.allFinite()) throw instance_.error("proposed a guess that is not finite");
  return {nonzero, std::max(products, 0)};
}

void PluginGuess::accept(const SolvePosition&, const VectorX& solution) {
  if (const auto accept = instance_.functions().accept) instance_.call(accept, &system_, solution.data());
}

}  // namespace rodsweep
