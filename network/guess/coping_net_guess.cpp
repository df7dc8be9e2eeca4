#include "network/guess/coping_net_guess.hpp"

#include "network/guess/base_guess.hpp"

namespace rodsweep {

CopingNetGuess::CopingNetGuess(std::shared_ptr<const Model> model, const Scene& scene, int newton_iterations,
                               FactorUse use)
    : model_(std::move(model)),
      scene_(scene),
      use_(use),
      base_(base_guess(model_->net.settings(), scene, newton_iterations)),
      corrections_(scene.rods.size()) {}

Proposal CopingNetGuess::propose(const LinearSystem& system, const SolvePosition& at, VectorX& x0) {
  const auto r = static_cast<std::size_t>(at.rod);
  const Rod& rod = scene_.rods[r];
  if (!corrections_[r]) corrections_[r] = std::make_unique<CopingNetCorrection>(model_, rod, system.matrix(), use_);
  Proposal proposal = base_->propose(system, at, x0);
  corrections_[r]->correct(rod, system, at, proposal, x0, nullptr);
  return proposal;
}

}  // namespace rodsweep
