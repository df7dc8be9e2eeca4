#include "network/coping_net_guess.hpp"

#include <cmath>

#include "network/base_guess.hpp"

namespace rodsweep {

/// What one rod's solves use again and again.
struct CopingNetGuess::RodBuffers {
  FeatureEncoder encoder;
  std::unique_ptr<SweepsInference> sweeps;
  CopingNet<float>::Tape tape;
  Tensor<float> nodes, edges, y;
  VectorX residual, d, ad;

  RodBuffers(const Model& model, const Rod& rod, const BlockMatrix& a)
      : encoder(model.net.settings(), rod, a),
        nodes(node_features(model.net.settings()), rod.segment_count()),
        edges(edge_features(model.net.settings()), rod.joint_count()),
        y(6, rod.joint_count()),
        residual(a.unknowns()),
        d(a.unknowns()),
        ad(a.unknowns()) {
    const CopingNetSettings& settings = model.net.settings();
    if (settings.processor == Processor::sweeps && settings.encoding == Encoding::system &&
        SweepsInference::supports(settings.latent))
      sweeps = std::make_unique<SweepsInference>(model.net.sweeps(), model.net.parameters(), rod.joint_count());
    if (settings.processor == Processor::sweeps && encoder.topology().forest.order.empty())
      throw SceneError("the joints close a loop: a network with sweeps needs trees, one with message passing does not");
  }
};

CopingNetGuess::CopingNetGuess(std::shared_ptr<const Model> model, const Scene& scene, double dt_c,
                               int newton_iterations)
    : model_(std::move(model)),
      scene_(scene),
      dt_c_(dt_c),
      base_(base_guess(model_->net.settings(), scene, newton_iterations)),
      rods_(scene.rods.size()) {}

CopingNetGuess::~CopingNetGuess() = default;

CopingNetGuess::RodBuffers& CopingNetGuess::buffers_of(const LinearSystem& system, int rod) {
  const auto r = static_cast<std::size_t>(rod);
  if (!rods_[r]) rods_[r] = std::make_unique<RodBuffers>(*model_, scene_.rods[r], system.matrix());
  return *rods_[r];
}

Proposal CopingNetGuess::propose(const LinearSystem& system, const SolvePosition& at, VectorX& x0) {
  Proposal proposal = base_->propose(system, at, x0);
  RodBuffers& rod = buffers_of(system, at.rod);
  if (proposal.nonzero) {
    system.matrix().multiply(x0.data(), rod.residual.data());
    rod.residual = system.rhs() - rod.residual;
    ++proposal.products;
  } else {
    rod.residual = system.rhs();
  }
  correction(system, at, x0, rod);
  double length = 1;
  if (model_->net.settings().best_length) {
    system.matrix().multiply(rod.d.data(), rod.ad.data());
    ++proposal.products;
    length = rod.d.dot(rod.residual) / rod.d.dot(rod.ad);
  }
  if (!std::isfinite(length) || !rod.d.allFinite()) return proposal;
  x0 += length * rod.d;
  proposal.nonzero = true;
  return proposal;
}

/// Sets rod.d.
void CopingNetGuess::correction(const LinearSystem& system, const SolvePosition& at, const VectorX& x0,
                                RodBuffers& rod) {
  const Topology& topology = rod.encoder.topology();
  const bool graphs = model_->net.settings().encoding != Encoding::system;
  rod.encoder.encode(scene_.rods[static_cast<std::size_t>(at.rod)], system, at.newton, dt_c_, x0, rod.residual,
                     rod.nodes, rod.edges);
  if (graphs) {
    model_->scales.nodes.apply(rod.nodes);
    model_->scales.edges.apply(rod.edges);
  }
  if (rod.sweeps)
    rod.sweeps->run(topology.forest, rod.edges, rod.y);
  else
    model_->net.forward(topology, rod.nodes, rod.edges, rod.tape, rod.y, nullptr);
  if (graphs) rod.y.array().colwise() *= model_->scales.multipliers.deviation;
  for (Eigen::Index place = 0; place < rod.y.cols(); ++place) {
    const Eigen::Index first = 6 * topology.joint[static_cast<std::size_t>(place)];
    rod.d.segment<6>(first) = rod.y.col(place).cast<double>();
    if (!graphs) rod.d.segment<6>(first).array() *= rod.encoder.system_unit().segment<6>(first).array();
  }
}

}  // namespace rodsweep
