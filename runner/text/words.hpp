// The words of a choice and their values; words without capitals.
#pragma once

#include <algorithm>
#include <cctype>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace rodsweep {

template <class Value>
using Words = std::vector<std::pair<const char*, Value>>;

template <class Value>
Value value_of(const Words<Value>& words, const std::string& word) {
  const auto found = std::find_if(words.begin(), words.end(), [&](const auto& entry) { return word == entry.first; });
  if (found == words.end()) throw std::logic_error("no value for the choice " + word);
  return found->second;
}

template <class Value>
const char* word_of(const Words<Value>& words, Value value) {
  const auto found = std::find_if(words.begin(), words.end(), [&](const auto& entry) { return value == entry.second; });
  if (found == words.end()) throw std::logic_error("a choice without a word");
  return found->first;
}

/// For ASCII.
inline std::string lower_case(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

// Finds the known word nearest to a mistyped one, for "did you mean". Distance: Damerau-Levenshtein (optimal string
// alignment), ignoring case. A word that continues the mistyped one ("length" -> "length_m") is also near.

/// Empty if none of `known` is near enough.
std::string nearest(std::string_view word, const std::vector<std::string>& known);

/// "; did you mean "length_m"?", or empty.
std::string did_you_mean(std::string_view word, const std::vector<std::string>& known);

// Shortens a user's text for messages; cuts between characters.

inline std::string shortened(const std::string& text, std::size_t longest = 60) {
  if (text.size() <= longest) return text;
  std::size_t end = longest;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;  // inside a UTF-8 character
  return text.substr(0, end) + "...";
}

}  // namespace rodsweep
