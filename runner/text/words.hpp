// The words of a choice and their values; words without capitals.
#pragma once

#include <algorithm>
#include <cctype>
#include <stdexcept>
#include <string>
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

}  // namespace rodsweep
