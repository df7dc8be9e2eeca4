// Where the values of two jobs differ. Values include defaults; the layout of the JSON text, the order of keys and the
// form of a number (1000, 1e3) make no difference.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "runner/job/job.hpp"

namespace rodsweep {

struct JobDifference {
  std::string key;          ///< "scene.length_m"
  std::string now, before;  ///< shown() values
};

/// A value for a message: its JSON, shortened; "nothing" for null, which stands for a missing key.
std::string shown(const nlohmann::ordered_json& value);

/// The first difference; none if the jobs are the same. Names, descriptions and $schema may differ.
std::optional<JobDifference> first_difference(const Job& now, const Job& before);

}  // namespace rodsweep
