#include "network/guess/coping_net_correction.hpp"

#include <cmath>
#include <stdexcept>

namespace rodsweep {

CopingNetCorrection::CopingNetCorrection(std::shared_ptr<const Model> model, const Rod& rod, const BlockMatrix& a,
                                         FactorUse use)
    : model_(std::move(model)),
      use_(use),
      encoder_(model_->net.settings(), rod, a),
      nodes_(node_features(model_->net.settings()), rod.segment_count()),
      edges_(edge_features(model_->net.settings()), rod.joint_count()),
      y_edges_(6, rod.joint_count()),
      y_nodes_(6, rod.segment_count()),
      residual_(a.unknowns()),
      d_(a.unknowns()),
      ad_(a.unknowns()),
      previous_(a.unknowns()) {
  const CopingNetSettings& settings = model_->net.settings();
  if ((use.corrections > 1 || use.lag_steps > 0 || use.stop_at > 0) && settings.processor != Processor::factors)
    throw std::invalid_argument("CopingNetCorrection: corrections, lag_steps and stop_at need a model with factors");
  if (settings.processor == Processor::factors) factors_.emplace(*model_, encoder_);
  may_harm_ = encoder_.topology().forest.cut && factors_ && !has_all_couplings(settings);
  if (may_harm_) base_.resize(a.unknowns());
}

bool CopingNetCorrection::correct(const Rod& rod, const LinearSystem& system, const SolvePosition& at,
                                  Proposal& proposal, VectorX& x, std::vector<Lane8>* moves) {
  const BlockMatrix& a = system.matrix();
  if (proposal.nonzero) {
    system.multiply(x.data(), residual_.data());
    residual_ = system.rhs() - residual_;
    ++proposal.products;
  } else {
    residual_ = system.rhs();
  }
  const bool may_harm = may_harm_ && !moves;
  const double before = may_harm ? jacobi_norm_squared(a, residual_) : 0;
  if (may_harm) base_ = x;

  const double most = use_.stop_at > 0 ? use_.stop_at * use_.stop_at * system.rhs().squaredNorm() : 0;
  const auto small_enough = [&] { return use_.stop_at > 0 && residual_.squaredNorm() <= most; };
  if (small_enough()) {
    proposal.residual = &residual_;
    return true;
  }
  if (factors_serve(at)) {
    factors_->solve(residual_, d_);
  } else {
    run(rod, system, at, x, moves != nullptr);
    proposal.renewed = use_.lag_steps > 0;
    proposal.with_network = true;
  }
  double length = 1, energy = 0;
  const bool best_length = model_->net.settings().best_length || use_.corrections > 1, known = best_length || may_harm;
  if (known) {
    system.multiply(d_.data(), ad_.data());
    ++proposal.products;
  }
  if (best_length) {
    energy = d_.dot(ad_);
    length = energy == 0 ? 0 : d_.dot(residual_) / energy;
  }
  proposal.residual = &residual_;  // of the current x
  if (!std::isfinite(length) || !d_.allFinite() || (moves && !write(*moves))) return false;
  const auto move = [&] {
    x += length * d_;
    if (known) residual_ -= length * ad_;
  };
  const bool moved = length != 0;
  move();
  for (int i = 1; i < use_.corrections && energy > 0 && !small_enough(); ++i) {
    energy = correct_again(system, energy, length);
    ++proposal.products;
    if (!(energy > 0) || !std::isfinite(length)) break;
    move();
  }
  if (!known) proposal.residual = nullptr;
  if (may_harm && !(jacobi_norm_squared(a, residual_) <= before)) {
    x = base_;
    proposal.residual = nullptr;
    return true;
  }
  proposal.nonzero = proposal.nonzero || moved;
  return true;
}

/// Whether earlier factors are reused. A second proposal for the same solve factorises again, so it takes as long.
bool CopingNetCorrection::factors_serve(const SolvePosition& at) const {
  if (!factorised_at_ || at.step - factorised_at_->step >= use_.lag_steps) return false;
  return at.step != factorised_at_->step || at.newton != factorised_at_->newton;
}

/// Sets the next direction of conjugate gradients, d_ = F r - (F r . A d_) / (d_ . A d_) d_, A d_ and the best length
/// along d_. Returns the energy d_ . A d_.
double CopingNetCorrection::correct_again(const LinearSystem& system, double energy, double& length) {
  previous_.swap(d_);
  factors_->solve(residual_, d_);
  d_ -= d_.dot(ad_) / energy * previous_;
  system.multiply(d_.data(), ad_.data());
  energy = d_.dot(ad_);
  length = energy > 0 ? d_.dot(residual_) / energy : 0;
  return energy;
}

/// Sets d_ and, on request, y_nodes_.
void CopingNetCorrection::run(const Rod& rod, const LinearSystem& system, const SolvePosition& at, const VectorX& x,
                              bool with_moves) {
  encoder_.encode(rod, system, at.newton, x, residual_, nodes_, edges_);
  if (is_of_graphs(model_->net.settings().encoding)) {
    model_->scales.nodes.apply(nodes_);
    model_->scales.edges.apply(edges_);
  }
  if (!factors_) return answer(with_moves);
  factors_->factorise(encoder_, edges_, system.matrix());
  factorised_at_ = at;
  factors_->solve(residual_, d_);
}

/// Sets d_ and, on request, y_nodes_ from the features.
void CopingNetCorrection::answer(bool with_moves) {
  const Topology& topology = encoder_.topology();
  model_->net.forward(topology, nodes_, edges_, tape_, y_edges_, with_moves ? &y_nodes_ : nullptr);
  if (is_of_graphs(model_->net.settings().encoding)) y_edges_.array().colwise() *= model_->scales.multipliers.deviation;
  for (Eigen::Index place = 0; place < y_edges_.cols(); ++place) {
    const Eigen::Index first = 6 * topology.joint[static_cast<std::size_t>(place)];
    const float* y = y_edges_.col(place).data();
    if (const SystemEncoding* scaled = encoder_.system())
      store6(d_.data() + first,
             scaled->from_unit(static_cast<int>(place), Lane8{y[0], y[1], y[2], y[3], y[4], y[5], 0, 0}));
    else
      d_.segment<6>(first) = y_edges_.col(place).cast<double>();
  }
}

/// Writes the moves of the segments. Returns false if they are not finite.
bool CopingNetCorrection::write(std::vector<Lane8>& moves) const {
  const Eigen::ArrayXf& unit = model_->scales.moves.deviation;
  moves.resize(static_cast<std::size_t>(y_nodes_.cols()));
  bool finite = true;
  for (Eigen::Index s = 0; s < y_nodes_.cols(); ++s) {
    const Vector6 move = (y_nodes_.col(s).array() * unit).cast<double>();
    moves[static_cast<std::size_t>(s)] = load6(move.data());
    finite = finite && move.allFinite();
  }
  return finite;
}

}  // namespace rodsweep
