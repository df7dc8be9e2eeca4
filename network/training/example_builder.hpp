// Recorded simulations as examples to learn from.
//
// The base guess runs along, reading the exact history as it does in a paired evaluation. Systems whose residual is at
// rounding level (the base guess is the solution) teach nothing and are left out.
#pragma once

#include "network/encoding/feature_encoder.hpp"
#include "network/encoding/stored_simulation.hpp"
#include "network/training/example.hpp"

namespace rodsweep {

/// Adds the examples of one simulation, their features and targets without normalisation.
void add_examples(const CopingNetSettings& settings, const StoredSimulation& simulation, std::vector<Example>& out);

/// The scales of a training set of such examples.
FeatureScales feature_scales(const CopingNetSettings& settings, const std::vector<Example>& examples);

/// Brings features, units and targets to these scales; once per example.
void normalise(const CopingNetSettings& settings, const FeatureScales& scales, std::vector<Example>& examples);

}  // namespace rodsweep
