#include "network/training/example_builder.hpp"

#include <algorithm>
#include <memory>
#include <numeric>

#include "network/guess/base_guess.hpp"
#include "network/training/state_examples.hpp"
#include "network/training/turn.hpp"
#include "solver/linear/solve_outcome.hpp"

namespace rodsweep {
namespace {

/// The encoder and the buffers of one rod.
struct RodExamples {
  FeatureEncoder encoder;
  VectorX base, residual, scale;
  std::vector<Lane8> moves;
  Tensor<float> edges;

  RodExamples(const CopingNetSettings& settings, const Rod& rod, const LinearSystem& system)
      : encoder(settings, rod, system.matrix()),
        base(VectorX::Zero(system.rhs().size())),
        residual(base),
        scale(base),
        moves(rod.segments.size()) {}
};

double length_of(const Rod& rod) {
  return std::accumulate(rod.segments.begin(), rod.segments.end(), 0.0,
                         [](double sum, const Segment& segment) { return sum + segment.length_m; });
}

/// `values` (six per joint) in the places of the topology.
Tensor<float> by_place(const Topology& topology, const VectorX& values) {
  Tensor<float> out(6, static_cast<Eigen::Index>(topology.joint.size()));
  for (Eigen::Index place = 0; place < out.cols(); ++place)
    out.col(place) = values.segment<6>(6 * topology.joint[static_cast<std::size_t>(place)]).cast<float>();
  return out;
}

/// Sets the system, and the units and targets of outputs.
void put_system(const LinearSystem& system, const StoredSystem& stored, RodExamples& of, Example& out) {
  const SystemPattern& pattern = of.encoder.pattern();
  const VectorX error = stored.solution - of.base;
  // A base that is far worse than zero, as in solves that change nothing, would drown all other examples.
  const double unit_energy = std::max(stored.solution.dot(system.rhs()), error.dot(of.residual));
  if (const SystemEncoding* scaled = of.encoder.system()) {
    out.system = canonical_system(pattern, scaled->frames(), system.matrix(), of.residual, error, unit_energy);
    out.edge_target.resize(6, out.system.residual.cols());
    for (int place = 0; place < static_cast<int>(out.edge_target.cols()); ++place) {
      const int joint = pattern.joint[static_cast<std::size_t>(place)];
      const Lane8 target = scaled->to_unit(place, load6(error.data() + 6 * joint));
      for (int row = 0; row < 6; ++row) out.edge_target(row, place) = static_cast<float>(target[row]);
    }
    return;
  }
  out.system = scaled_system(pattern, system.matrix(), of.residual, error, unit_energy);
  correction_scale(system.matrix(), of.residual, of.scale);
  out.unit = by_place(*out.topology, of.scale.cwiseInverse());
  out.edge_target = by_place(*out.topology, error);
}

/// `seen` is the system's rod after `turn`.
Example example_of(const CopingNetSettings& settings, const Rod& rod, const LinearSystem& system,
                   const StoredSystem& stored, RodExamples& of, const Rod& seen, const Turn& turn) {
  Example out;
  out.topology = of.encoder.shared_topology();
  out.nodes.resize(node_features(settings), rod.segment_count());
  of.edges.resize(edge_features(settings), rod.joint_count());
  of.encoder.encode(seen, system, stored.at.newton, of.base, of.residual, out.nodes, of.edges);
  if (is_of_graphs(settings.encoding)) out.edges = of.edges;
  put_system(system, stored, of, out);
  if (settings.moves) {
    out.node_target.resize(6, rod.segment_count());
    system.displacements(rod, stored.solution, of.moves);
    for (Eigen::Index s = 0; s < out.node_target.cols(); ++s) {
      Vector6 move;
      for (int k = 0; k < 6; ++k) move[k] = of.moves[static_cast<std::size_t>(s)][k];
      out.node_target.col(s) << (turn.rotation * move.head<3>()).cast<float>(),
          (turn.rotation * move.tail<3>()).cast<float>();
    }
  } else {
    out.node_target.resize(6, 0);
  }
  return out;
}

}  // namespace

void add_examples(const CopingNetSettings& settings, const StoredSimulation& simulation, std::vector<Example>& out,
                  const Copies& copies, bool first_iterations_only) {
  if (!is_guess(settings)) return add_state_examples(settings, simulation, out, copies);
  Replay replay(simulation);
  const Scene& scene = replay.scene();
  const std::unique_ptr<InitialGuess> base = base_guess(settings, scene, simulation.newton_iterations);
  SplitMix random(copies.seed);
  std::vector<RodExamples> rods;
  for (std::size_t r = 0; r < scene.rods.size(); ++r) rods.emplace_back(settings, scene.rods[r], replay.systems()[r]);
  replay.run([&](const StoredSystem& stored, const Rod& rod, const LinearSystem& system) {
    RodExamples& of = rods[static_cast<std::size_t>(stored.at.rod)];
    base->prepare(stored.at);
    base->propose(system, stored.at, of.base);
    system.multiply(of.base.data(), of.residual.data());
    of.residual = system.rhs() - of.residual;
    const bool wanted = stored.at.newton == 0 || !first_iterations_only;
    if (wanted && of.residual.lpNorm<Eigen::Infinity>() > rounding_level) {
      out.push_back(example_of(settings, rod, system, stored, of, rod, {}));
      for (int copy = 0; copy < copies.count; ++copy) {
        const Turn turn = random_turn(scene.gravity_m_s2, length_of(rod), random);
        out.push_back(example_of(settings, rod, system, stored, of, turned(rod, turn), turn));
      }
    }
    base->accept(system, stored.at, stored.solution);
  });
}

FeatureScales feature_scales(const CopingNetSettings& settings, const std::vector<Example>& examples) {
  if (!has_scales(settings)) return {};
  FeatureStatistics nodes(node_groups(settings)), edges(edge_groups(settings)), multipliers({3, 3}), moves({3, 3});
  for (const Example& example : examples) {
    nodes.accumulate(example.nodes);
    edges.accumulate(example.edges);
    if (is_guess(settings)) multipliers.accumulate(example.edge_target);
    if (settings.moves) moves.accumulate(example.node_target);
  }
  return {nodes.normalisation(), edges.normalisation(),
          is_guess(settings) ? multipliers.normalisation() : Normalisation{},
          settings.moves ? moves.normalisation() : Normalisation{}};
}

void normalise(const CopingNetSettings& settings, const FeatureScales& scales, std::vector<Example>& examples) {
  if (!has_scales(settings)) return;
  for (Example& example : examples) {
    scales.nodes.apply(example.nodes);
    scales.edges.apply(example.edges);
    if (is_guess(settings)) {
      example.unit.array().colwise() *= scales.multipliers.deviation;
      example.edge_target.array().colwise() /= scales.multipliers.deviation;
    }
    if (settings.moves) example.node_target.array().colwise() /= scales.moves.deviation;
  }
}

}  // namespace rodsweep
