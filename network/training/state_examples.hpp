// Examples for a simulator that updates states (network/encoding/state_encoding.hpp), from recorded velocities only:
// the next velocity after five of them.
//
// Copies of an example are rolled about the segments' axes by a random angle, the same for all segments, and have a
// history with noise. Their target still gives the recorded velocities, so that a simulator learns to correct its
// earlier errors. Noise is relative to the root mean square of a step's changes of velocities in the simulation.
#pragma once

#include "network/training/example_builder.hpp"

namespace rodsweep {

/// Adds the examples of one simulation, without normalisation. A rod's examples end at its first step without a system.
void add_state_examples(const CopingNetSettings& settings, const StoredSimulation& simulation,
                        std::vector<Example>& out, const Copies& copies);

}  // namespace rodsweep
