// Recorded simulations as examples to learn from.
//
// The base guess runs along, reading the exact history as it does in a paired evaluation. Systems whose residual is at
// rounding level (the base guess is the solution) teach nothing and are left out. Encodings that say where a rod is may
// have copies of every example, turned about gravity and shifted at random (turn.hpp): only what is of the world moves.
// Of `state` see state_examples.hpp.
#pragma once

#include "network/encoding/feature_encoder.hpp"
#include "network/encoding/stored_simulation.hpp"
#include "network/training/example.hpp"

namespace rodsweep {

struct Copies {
  int count = 0;           ///< of every example
  double noise = 0;        ///< state: of theirs, relative
  std::uint64_t seed = 0;  ///< of a simulation
};

/// Adds the examples of one simulation, their features and targets without normalisation; on request those of first
/// Newton iterations alone.
void add_examples(const CopingNetSettings& settings, const StoredSimulation& simulation, std::vector<Example>& out,
                  const Copies& copies = {}, bool first_iterations_only = false);

/// The scales of a training set of such examples.
FeatureScales feature_scales(const CopingNetSettings& settings, const std::vector<Example>& examples);

/// Brings features, units and targets to these scales; once per example.
void normalise(const CopingNetSettings& settings, const FeatureScales& scales, std::vector<Example>& examples);

}  // namespace rodsweep
