#include "runner/keys/sweep_words.hpp"

namespace rodsweep {

const std::vector<std::string>& sweep_words() {
  static const std::vector<std::string> words{"grid", "zip", "uniform", "log_uniform", "integer"};
  return words;
}

std::string sweep_word(const nlohmann::ordered_json& value) {
  if (value.is_object()) {
    for (const std::string& word : sweep_words()) {
      if (value.contains(word)) return word;
    }
  }
  return {};
}

std::string guess_label(const nlohmann::ordered_json& guess) {
  return (sweep_word(guess).empty() ? guess.begin().value() : guess)["label"];
}

bool is_listed(const std::string& sweep_word) { return sweep_word == "grid" || sweep_word == "zip"; }

}  // namespace rodsweep
