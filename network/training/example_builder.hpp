// Training examples from recorded simulations.
//
// The base guess is evaluated on the exact history, as in a paired evaluation. Systems with a residual at rounding
// level (the base guess is the solution) are left out. Encodings that depend on the rod's position may have copies of
// every example, rotated about gravity and shifted at random (turn.hpp). For `state` see state_examples.hpp.
#pragma once

#include "network/encoding/feature_encoder.hpp"
#include "network/encoding/stored_simulation.hpp"
#include "network/training/example.hpp"

namespace rodsweep {

struct Copies {
  int count = 0;           ///< of every example
  double noise = 0;        ///< `state`: relative noise of the copies
  std::uint64_t seed = 0;  ///< per simulation
};

/// Adds the examples of one simulation, without normalising features and targets; with `first_iterations_only`, those
/// of first Newton iterations.
void add_examples(const CopingNetSettings& settings, const StoredSimulation& simulation, std::vector<Example>& out,
                  const Copies& copies = {}, bool first_iterations_only = false);

/// The scales of a training set of such examples.
FeatureScales feature_scales(const CopingNetSettings& settings, const std::vector<Example>& examples);

/// Scales features, units and targets; call once per example.
void normalise(const CopingNetSettings& settings, const FeatureScales& scales, std::vector<Example>& examples);

}  // namespace rodsweep
