// What the value of a key that stands for many is called, in a column of the tasks over which it varies:
//
//   "none"                                    a word in place of an object: itself
//   "friction 0.3", "friction 0.6, sweeps 9"  an object: its members without a default or with another value, at least
//                                             the first; not those that are swept, which have columns of their own
//   "half_space, ball", "none"                a list: its items by their kinds; none
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "runner/job/key.hpp"

namespace rodsweep {

/// Can values of `key` differ although no column of a member does?
bool has_option_label(const Key& key);

/// Of a validated job's value of such a key, with its defaults.
std::string option_label(const Key& key, const nlohmann::ordered_json& value);

}  // namespace rodsweep
