// Recognises sweeps in a job: a sweep is an object whose only key is a sweep word.
#pragma once

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

#include "runner/keys/key.hpp"

namespace rodsweep {

/// "grid", "zip", "uniform", "log_uniform", "integer".
const std::vector<std::string>& sweep_words();

/// The sweep word among an object's keys, also if it has other keys; empty if none.
std::string sweep_word(const nlohmann::ordered_json& value);

/// The label of a guess in a validated job.
std::string guess_label(const nlohmann::ordered_json& guess);

/// Whether this sweep has a list of values (grid, zip) instead of a range to draw from.
bool is_listed(const std::string& sweep_word);

// Labels of values of keys that contain other keys, for a column of the tasks if they vary:
//
//   "none"                                    a word instead of an object: the word
//   "friction 0.3", "friction 0.6, sweeps 9"  an object: members without a default or with another value, at least
//                                             the first; without swept members, which have their own columns
//   "half_space, ball", "none"                a list: the kinds of its items; an empty list

/// Whether values of `key` can differ although all columns of its members are equal.
bool has_option_label(const Key& key);

/// The label of a value of such a key in a validated job, with defaults.
std::string option_label(const Key& key, const nlohmann::ordered_json& value);

}  // namespace rodsweep
