#include "network/example_builder.hpp"

#include <memory>

#include "network/base_guess.hpp"
#include "solver/linear_system.hpp"

namespace rodsweep {
namespace {

constexpr double rounding = 1e-13;  // of the residual's entries, as in the measurements (max |r|, dimensionless)

/// What one rod needs again and again.
struct RodExamples {
  LinearSystem system;
  FeatureEncoder encoder;
  VectorX base, residual, scale;
  std::vector<Lane8> moves;

  RodExamples(const CopingNetSettings& settings, const Rod& rod)
      : system(rod),
        encoder(settings, rod, system.matrix()),
        base(VectorX::Zero(system.rhs().size())),
        residual(base),
        scale(base),
        moves(rod.segments.size()) {}
};

/// `values` (six per joint) in the places of the topology.
Tensor<float> by_place(const Topology& topology, const VectorX& values) {
  Tensor<float> out(6, static_cast<Eigen::Index>(topology.joint.size()));
  for (Eigen::Index place = 0; place < out.cols(); ++place)
    out.col(place) = values.segment<6>(6 * topology.joint[static_cast<std::size_t>(place)]).cast<float>();
  return out;
}

Example example_of(const CopingNetSettings& settings, const Rod& rod, const RecordedSystem& recorded, double dt_c,
                   RodExamples& of) {
  Example out;
  out.topology = of.encoder.shared_topology();
  out.nodes.resize(node_features(settings), rod.segment_count());
  out.edges.resize(edge_features(settings), rod.joint_count());
  of.encoder.encode(rod, of.system, recorded.at.newton, dt_c, of.base, of.residual, out.nodes, out.edges);
  const VectorX error = recorded.solution - of.base;
  out.system = scaled_system(of.encoder.pattern(), of.system.matrix(), of.residual, error,
                             recorded.solution.dot(of.system.rhs()));
  correction_scale(of.system.matrix(), of.residual, of.scale);
  if (settings.encoding == Encoding::system) {
    out.unit = Tensor<float>::Ones(6, rod.joint_count());
    out.edge_target = by_place(*out.topology, error.cwiseQuotient(of.scale));
  } else {
    out.unit = by_place(*out.topology, of.scale.cwiseInverse());
    out.edge_target = by_place(*out.topology, error);
  }
  if (settings.moves) {
    out.node_target.resize(6, rod.segment_count());
    of.system.displacements(rod, recorded.solution, of.moves);
    for (Eigen::Index s = 0; s < out.node_target.cols(); ++s)
      for (int k = 0; k < 6; ++k) out.node_target(k, s) = static_cast<float>(of.moves[static_cast<std::size_t>(s)][k]);
  } else {
    out.node_target.resize(6, 0);
  }
  return out;
}

}  // namespace

void add_examples(const CopingNetSettings& settings, const RecordedSimulation& simulation, std::vector<Example>& out) {
  Scene scene = simulation.scene;
  const std::unique_ptr<InitialGuess> base = base_guess(settings, scene, simulation.newton_iterations);
  std::vector<RodExamples> rods;
  rods.reserve(scene.rods.size());
  for (const Rod& rod : scene.rods) rods.emplace_back(settings, rod);
  for (const RecordedSystem& recorded : simulation.systems) {
    Rod& rod = scene.rods[static_cast<std::size_t>(recorded.at.rod)];
    RodExamples& of = rods[static_cast<std::size_t>(recorded.at.rod)];
    restore(recorded, rod);
    of.system.assemble(rod, simulation.constraint_dt_s);
    base->propose(of.system, recorded.at, of.base);
    of.system.matrix().multiply(of.base.data(), of.residual.data());
    of.residual = of.system.rhs() - of.residual;
    if (of.residual.lpNorm<Eigen::Infinity>() > rounding)
      out.push_back(example_of(settings, rod, recorded, simulation.constraint_dt_s, of));
    base->accept(recorded.at, recorded.solution);
  }
}

FeatureScales feature_scales(const CopingNetSettings& settings, const std::vector<Example>& examples) {
  if (settings.encoding == Encoding::system) return {};
  FeatureStatistics nodes(node_groups(settings)), edges(edge_groups(settings)), multipliers({3, 3}), moves({3, 3});
  for (const Example& example : examples) {
    nodes.accumulate(example.nodes);
    edges.accumulate(example.edges);
    multipliers.accumulate(example.edge_target);
    if (settings.moves) moves.accumulate(example.node_target);
  }
  return {nodes.normalisation(), edges.normalisation(), multipliers.normalisation(),
          settings.moves ? moves.normalisation() : Normalisation{}};
}

void normalise(const CopingNetSettings& settings, const FeatureScales& scales, std::vector<Example>& examples) {
  if (settings.encoding == Encoding::system) return;
  for (Example& example : examples) {
    scales.nodes.apply(example.nodes);
    scales.edges.apply(example.edges);
    example.unit.array().colwise() *= scales.multipliers.deviation;
    example.edge_target.array().colwise() /= scales.multipliers.deviation;
    if (settings.moves) example.node_target.array().colwise() /= scales.moves.deviation;
  }
}

}  // namespace rodsweep
