// Training examples from recorded simulations.
//
// The base guess is evaluated on the exact history, as in a paired evaluation. Systems with a residual at rounding level
// (the base guess is the solution) are left out. Encodings that depend on where a rod is may have copies of every example,
// turned about gravity and shifted at random (turn.hpp). For `state` see state_examples.hpp.
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

/// Adds the examples of one simulation, with features and targets that are not normalised; on request those of first
/// Newton iterations only.
void add_examples(const CopingNetSettings& settings, const StoredSimulation& simulation, std::vector<Example>& out,
                  const Copies& copies = {}, bool first_iterations_only = false);

/// The scales of a training set of such examples.
FeatureScales feature_scales(const CopingNetSettings& settings, const std::vector<Example>& examples);

/// Scales features, units and targets; call once per example.
void normalise(const CopingNetSettings& settings, const FeatureScales& scales, std::vector<Example>& examples);

}  // namespace rodsweep
