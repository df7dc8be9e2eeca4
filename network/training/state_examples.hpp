// Examples for a simulator that updates states (network/encoding/state_encoding.hpp), from recorded velocities alone:
// what five of them say of the next.
//
// Copies of an example are rolled about the segments' axes by any angle, the same for all segments, and have a history
// with noise, whose exact answer still leads to the velocities that were recorded: so a simulator learns to take back
// what it erred before. Noise is relative to the root mean square of what a step adds to the simulation's velocities.
#pragma once

#include "network/training/example_builder.hpp"

namespace rodsweep {

/// Adds those of one simulation, without normalisation; of every rod up to its first step without a linear system.
void add_state_examples(const CopingNetSettings& settings, const StoredSimulation& simulation,
                        std::vector<Example>& out, const Copies& copies);

}  // namespace rodsweep
