// Values of a job that are allowed and still look like another unit: a radius in millimetres, a modulus in GPa, a
// density in g/cm^3, a rod that is thicker than long. A table of ranges that real rods keep, wide enough for hair and
// for a mast; outside of them the program computes what it was told.
#pragma once

#include <string>
#include <vector>

#include "runner/job/job.hpp"

namespace rodsweep {

/// Warnings, "my.json: time.step_s: 20 s is ...", one for each value, in the order of the job. Of a range its ends
/// count.
std::vector<std::string> implausible_values(const Job& job);

}  // namespace rodsweep
