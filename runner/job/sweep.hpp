// How a sweep is recognised in a job: an object with exactly one key, one of the sweep words.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace rodsweep {

/// "grid", "zip", "uniform", "log_uniform", "integer".
const std::vector<std::string>& sweep_words();

/// The sweep word among an object's keys, whatever else it holds; empty if there is none.
std::string sweep_word(const nlohmann::ordered_json& value);

/// The label of an entry of a validated job's list of guesses.
std::string guess_label(const nlohmann::ordered_json& guess);

/// Do the values of this sweep stand in a list (grid, zip), rather than being drawn from a range?
bool is_listed(const std::string& sweep_word);

}  // namespace rodsweep
