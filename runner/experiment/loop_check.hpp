// Guesses and networks that need rods without loops or branches, found before anything runs.
//
// A network with `sweeps` walks the joints as a forest, nearest neighbours compare rods along one arc length. A ring
// that is held has no loop for the former, since nothing couples through a held segment, but for the latter it has.
#pragma once

#include "runner/job/plan.hpp"

namespace rodsweep {

/// Throws JobError, naming the guess or the method; FileError where a model file that it needs is not one.
void check_loops(const Plan& plan);

}  // namespace rodsweep
