#include "network/training/state_examples.hpp"

#include <algorithm>
#include <cmath>

#include "network/encoding/state_encoding.hpp"

namespace rodsweep {
namespace {

using Steps = std::vector<const StoredSystem*>;  ///< of a rod, in order

std::vector<Steps> steps_of(const StoredSimulation& simulation) {
  std::vector<Steps> out(simulation.scene.rods.size());
  for (const StoredSystem& stored : simulation.systems) {
    Steps& of = out[static_cast<std::size_t>(stored.at.rod)];
    if (stored.at.newton == 0 && stored.at.step == static_cast<int>(of.size())) of.push_back(&stored);
  }
  return out;
}

struct Sizes {
  double velocity = 0, spin = 0;
};

/// Root mean squares of a step's changes of velocities and angular velocities.
Sizes usual_change(const std::vector<Steps>& rods) {
  Sizes squares;
  double entries = 0;
  for (const Steps& steps : rods)
    for (std::size_t n = 1; n < steps.size(); ++n)
      for (std::size_t s = 0; s < steps[n]->velocity.size(); ++s, entries += 3) {
        squares.velocity += (steps[n]->velocity[s] - steps[n - 1]->velocity[s]).squaredNorm();
        squares.spin += (steps[n]->angular_velocity[s] - steps[n - 1]->angular_velocity[s]).squaredNorm();
      }
  entries = std::max(entries, 1.0);
  return {std::sqrt(squares.velocity / entries), std::sqrt(squares.spin / entries)};
}

Example example_of(const CopingNetSettings& settings, const StateEncoding& encoding, const Rod& rod,
                   const StateHistory& history, const StoredSystem& next) {
  Example out;
  out.topology = encoding.shared_topology();
  out.nodes.resize(node_features(settings), rod.segment_count());
  out.edges.resize(edge_features(settings), rod.joint_count());
  encoding.encode(rod, history, out.nodes, out.edges);
  out.edge_target.resize(0, rod.joint_count());
  out.node_target.resize(6, rod.segment_count());
  StateEncoding::answer(rod, history, next.velocity, next.angular_velocity, out.node_target);
  return out;
}

void roll_all(double angle, Example& example) {
  roll(StateEncoding::node_groups(), angle, example.nodes);
  roll(StateEncoding::edge_groups(), angle, example.edges);
  roll({3, 3}, angle, example.node_target);
}

}  // namespace

void add_state_examples(const CopingNetSettings& settings, const StoredSimulation& simulation,
                        std::vector<Example>& out, const Copies& copies) {
  const std::vector<Steps> rods = steps_of(simulation);
  const Sizes change = usual_change(rods);
  SplitMix random(copies.seed);
  for (std::size_t r = 0; r < rods.size(); ++r) {
    const Rod& rod = simulation.scene.rods[r];
    const StateEncoding encoding(rod, simulation.scene.gravity_m_s2);
    StateHistory history(rod, simulation.step_s);
    for (std::size_t n = 0; n + 1 < rods[r].size(); ++n) {
      history.start_step(rods[r][n]->velocity, rods[r][n]->angular_velocity);
      const StoredSystem& next = *rods[r][n + 1];
      out.push_back(example_of(settings, encoding, rod, history, next));
      for (int copy = 0; copy < copies.count; ++copy) {
        const StateHistory disturbed =
            history.disturbed(rod, copies.noise * change.velocity, copies.noise * change.spin, random);
        out.push_back(example_of(settings, encoding, rod, disturbed, next));
        roll_all(2 * pi * random.uniform(), out.back());
      }
    }
  }
}

}  // namespace rodsweep
