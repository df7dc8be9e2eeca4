// Recognises sweeps in a job: a sweep is an object whose only key is a sweep word.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace rodsweep {

/// "grid", "zip", "uniform", "log_uniform", "integer".
const std::vector<std::string>& sweep_words();

/// The sweep word among an object's keys, also if it has other keys; empty if none.
std::string sweep_word(const nlohmann::ordered_json& value);

/// The label of a guess in a validated job.
std::string guess_label(const nlohmann::ordered_json& guess);

/// Whether this sweep has a list of values (grid, zip) instead of a range to draw from.
bool is_listed(const std::string& sweep_word);

}  // namespace rodsweep
