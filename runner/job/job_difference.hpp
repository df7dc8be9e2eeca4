// In which keys two jobs differ. Name, description and $schema do not count; guesses are compared by their label; a
// file that a key names counts as another where what is in it differs.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "runner/job/job.hpp"

namespace rodsweep {

struct KeyDifference {
  std::string path;             ///< "solve.tolerance", "guesses.pod 10"
  nlohmann::ordered_json a, b;  ///< null: it is not there
};

/// In the order of a, then of b.
std::vector<KeyDifference> job_differences(const Job& a, const Job& b);

}  // namespace rodsweep
