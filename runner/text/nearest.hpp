// Finds the known word nearest to a mistyped one, for "did you mean". Distance: Damerau-Levenshtein (optimal string
// alignment), ignoring case. A word that continues the mistyped one ("length" -> "length_m") is also near.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace rodsweep {

/// Empty if none of `known` is near enough.
std::string nearest(std::string_view word, const std::vector<std::string>& known);

/// "; did you mean "length_m"?", or empty.
std::string did_you_mean(std::string_view word, const std::vector<std::string>& known);

}  // namespace rodsweep
