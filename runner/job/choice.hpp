// What a word of a job stands for.
#pragma once

#include <map>
#include <stdexcept>
#include <string>

namespace rodsweep {

template <class Value>
Value choice(const std::map<std::string, Value>& words, const std::string& word) {
  const auto found = words.find(word);
  if (found == words.end()) throw std::logic_error("no value for the choice " + word);
  return found->second;
}

}  // namespace rodsweep
