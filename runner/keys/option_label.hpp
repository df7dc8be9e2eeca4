// Labels of values of keys that contain other keys, for a column of the tasks if they vary:
//
//   "none"                                    a word instead of an object: the word
//   "friction 0.3", "friction 0.6, sweeps 9"  an object: members without a default or with another value, at least
//                                             the first; without swept members, which have their own columns
//   "half_space, ball", "none"                a list: the kinds of its items; an empty list
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "runner/keys/key.hpp"

namespace rodsweep {

/// Whether values of `key` can differ although all columns of its members are equal.
bool has_option_label(const Key& key);

/// The label of a value of such a key in a validated job, with defaults.
std::string option_label(const Key& key, const nlohmann::ordered_json& value);

}  // namespace rodsweep
