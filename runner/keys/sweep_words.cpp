#include "runner/keys/sweep_words.hpp"

namespace rodsweep {
namespace {

using Json = nlohmann::ordered_json;

void append(std::string& label, const std::string& part) { label += (label.empty() ? "" : ", ") + part; }

std::string text(const Json& value) { return value.is_string() ? value.get<std::string>() : value.dump(); }

std::string of_object(const Key& key, const Json& value) {
  std::string label, first;
  for (const Key& member : key.keys) {
    if (!value.contains(member.name) || !sweep_word(value[member.name]).empty()) continue;
    const std::string said = member.name + " " + text(value[member.name]);
    if (first.empty()) first = said;
    if (member.preset != value[member.name]) append(label, said);
  }
  return !label.empty() ? label : !first.empty() ? first : "given";
}

std::string of_list(const Key& key, const Json& value) {
  std::string label;
  for (const Json& item : value) append(label, option_label(key.keys.front(), item));
  return label.empty() ? "none" : label;
}

}  // namespace

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

bool has_option_label(const Key& key) {
  return key.kind == Key::Kind::variant || key.kind == Key::Kind::list ||
         (key.kind == Key::Kind::object && !key.choices.empty());
}

std::string option_label(const Key& key, const Json& value) {
  if (!sweep_word(value).empty()) return "varying";
  if (value.is_string()) return value;
  if (key.kind == Key::Kind::variant) return value.begin().key();
  return key.kind == Key::Kind::list ? of_list(key, value) : of_object(key, value);
}

}  // namespace rodsweep
