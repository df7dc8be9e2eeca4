// Initial guesses in a job: names, keys, labels, and conversion to GuessSpec.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "runner/inputs/input_file.hpp"
#include "runner/keys/key.hpp"
#include "runner/keys/point.hpp"
#include "runner/specs/guess_spec.hpp"

namespace rodsweep {

/// Labels of the guesses of a validated job, in order.
std::vector<std::string> guess_labels(const nlohmann::ordered_json& guesses);

std::vector<GuessSpec> guess_specs(const Point& point, const std::vector<std::string>& labels, const JobFiles& job);

}  // namespace rodsweep
