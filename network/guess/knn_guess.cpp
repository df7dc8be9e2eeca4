#include "network/guess/knn_guess.hpp"

#include <algorithm>
#include <stdexcept>

namespace rodsweep {

KnnGuess::KnnGuess(std::shared_ptr<const KnnSet> training, const Scene& scene, int neighbours)
    : training_(std::move(training)), scene_(scene) {
  if (neighbours < 1)
    throw std::invalid_argument("KnnGuess: neighbours is " + std::to_string(neighbours) + "; must be at least 1");
  const auto k = static_cast<std::size_t>(neighbours);
  neighbours_ = {std::vector<std::uint32_t>(k), std::vector<float>(k)};
  for (const Rod& rod : scene.rods)
    rods_.push_back({ChainProfile(rod, scene.gravity_m_s2), Tensor<float>(ChainProfile::state_size, rod.joint_count()),
                     Tensor<float>(6, rod.joint_count())});
}

Proposal KnnGuess::propose(const LinearSystem& system, const SolvePosition& at, VectorX& x0) {
  RodBuffers& of = rods_[static_cast<std::size_t>(at.rod)];
  x0.setZero();
  of.profile.state(scene_.rods[static_cast<std::size_t>(at.rod)], system, system.dt(), of.state);
  const int found = training_->nearest(at.newton, KnnSet::query(of.profile, of.state), neighbours_);
  if (found == 0) return {};
  constexpr float same = 1e-6F;  // prevents a division by zero for a system of the training set itself
  const auto weight = [&](int i) { return 1 / std::max(neighbours_.distance[static_cast<std::size_t>(i)], same); };
  float sum = 0;
  for (int i = 0; i < found; ++i) sum += weight(i);
  of.loads.setZero();
  for (int i = 0; i < found; ++i) {
    const KnnSet::Loads loads = training_->loads(at.newton, neighbours_.system[static_cast<std::size_t>(i)]);
    add_resampled(loads.arc, loads.values, of.profile.arc(), weight(i) / sum, of.loads);
  }
  if (!of.loads.allFinite()) return {};
  of.profile.multipliers(of.loads, system.dt(), x0);
  return {true, 0};
}

}  // namespace rodsweep
