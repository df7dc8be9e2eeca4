#include "runner/keys/key.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "runner/keys/tables.hpp"

namespace rodsweep {
namespace {

Key make(Key::Kind kind, const char* name, const char* help) {
  Key key;
  key.kind = kind;
  key.name = name;
  key.help = help;
  return key;
}

std::string bounds(const Key& key) {
  const bool low = std::isfinite(key.low), high = std::isfinite(key.high);
  if (!low && !high) return "";
  if (low && high && !key.above_low) return fmt::format(" from {} to {}", key.low, key.high);
  std::string text;
  if (low) text += fmt::format(key.above_low ? " above {}" : " of at least {}", key.low);
  if (high) text += fmt::format("{} at most {}", low ? " and" : " of", key.high);
  return text;
}

}  // namespace

Key& Key::in(const char* si_unit) {
  unit = si_unit;
  return *this;
}
Key& Key::above(double bound) {
  low = bound;
  above_low = true;
  return *this;
}
Key& Key::at_least(double bound) {
  low = bound;
  above_low = false;
  return *this;
}
Key& Key::at_most(double bound) {
  high = bound;
  return *this;
}
Key& Key::from(double least, double most) { return at_least(least).at_most(most); }
Key& Key::plausibly(double least, double most, const char* known) {
  plausible = Plausible{least, most, known};
  return *this;
}
Key& Key::or_word(const char* word) {
  choices.emplace_back(word);
  return *this;
}
Key& Key::defaults_to(nlohmann::ordered_json value) {
  preset = std::move(value);
  return *this;
}
Key& Key::only(std::vector<std::string> tag_values, const char* advice) {
  only_for = std::move(tag_values);
  return otherwise(advice);
}
Key& Key::otherwise(const char* advice) {
  only_advice = advice;
  return *this;
}
Key& Key::one_of_group(const char* group) {
  alternative_group = group;
  return *this;
}
Key& Key::of_form(Text form) {
  text = form;
  return *this;
}
Key& Key::also_accepted_as(const char* name) {
  alias = name;
  return *this;
}
Key& Key::also_called(std::vector<std::string> words) {
  synonyms = std::move(words);
  return *this;
}
Key& Key::unswept(const char* advice) {
  sweepable = false;
  no_sweep_advice = advice;
  return *this;
}
Key& Key::or_list_of_such() {
  or_list = true;
  return *this;
}
Key& Key::unlabelled() {
  labelled = false;
  return *this;
}

Key& Key::on_sobol(int dimension) {
  sobol_dimension = dimension;
  return *this;
}

Key& Key::labelled_if_changed(const char* word) {
  labelled_as_preset = false;
  label_word = word;
  return *this;
}

Key& Key::setting() {
  sweepable = false;
  parameter = false;
  return *this;
}

Key object_key(const char* name, const char* help, std::vector<Key> keys, const char* tag) {
  Key key = make(Key::Kind::object, name, help);
  key.keys = std::move(keys);
  key.tag = tag;
  return key;
}
Key integer_key(const char* name, const char* help) { return make(Key::Kind::integer, name, help); }
Key boolean_key(const char* name, const char* help) { return make(Key::Kind::boolean, name, help); }
Key number_key(const char* name, const char* help) { return make(Key::Kind::number, name, help); }
Key vector_key(const char* name, const char* help) { return make(Key::Kind::vector, name, help); }
Key text_key(const char* name, const char* help) { return make(Key::Kind::text, name, help); }
Key file_key(const char* name, FileKind kind, const char* help) {
  Key key = text_key(name, help).at_most(4095).of_form(Key::Text::path);
  key.file = kind;
  return key;
}
Key choice_key(const char* name, const char* help, std::vector<std::string> choices) {
  Key key = make(Key::Kind::choice, name, help);
  key.choices = std::move(choices);
  return key;
}
Key variant_key(const char* name, const char* help, std::vector<Key> kinds) {
  Key key = make(Key::Kind::variant, name, help);
  key.keys = std::move(kinds);
  return key;
}
Key list_key(const char* name, const char* help, Key item) {
  Key key = make(Key::Kind::list, name, help);
  key.keys.push_back(std::move(item));
  return key;
}
Key guess_key(const char* name, const char* help) { return make(Key::Kind::guess, name, help); }
Key guesses_key(const char* name, const char* help) { return make(Key::Kind::guesses, name, help); }

Key item_key(const Key& listed) {
  Key key = listed;
  key.or_list = false;
  return key;
}

Key component_key(const Key& vector) {
  Key key = vector;
  key.kind = Key::Kind::number;
  return key;
}

nlohmann::ordered_json number(double value) {
  if (std::trunc(value) == value && std::abs(value) <= 9007199254740991) return static_cast<std::int64_t>(value);
  return value;
}

std::string quoted_list(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += fmt::format("{}\"{}\"", text.empty() ? "" : ", ", word);
  return text;
}

std::string allowed(const Key& key) {
  if (key.or_list) return allowed(item_key(key)) + ", or a non-empty list of these";
  switch (key.kind) {
    case Key::Kind::object: return "an object {...}" + (key.choices.empty() ? "" : ", or " + quoted_list(key.choices));
    case Key::Kind::integer: return "an integer" + bounds(key);
    case Key::Kind::boolean: return "true or false";
    case Key::Kind::number:
      return "a number" + bounds(key) + (key.choices.empty() ? "" : ", or " + quoted_list(key.choices));
    case Key::Kind::vector: return "three numbers [x, y, z], each" + (bounds(key).empty() ? " finite" : bounds(key));
    case Key::Kind::text:
      if (key.text == Key::Text::any) return "a string";
      if (key.text == Key::Text::path) return "the path of a file";
      if (key.text == Key::Text::line) return fmt::format("a string of 1 to {} characters on one line", key.high);
      return fmt::format(
          "a file name of 1 to {} letters, digits, \"_\", \"-\" or \".\", not beginning with \"-\" or \".\"", key.high);
    case Key::Kind::choice: return (key.choices.size() > 1 ? "one of " : "") + quoted_list(key.choices);
    case Key::Kind::variant: {
      std::vector<std::string> kinds;
      for (const Key& kind : key.keys) kinds.push_back(kind.name);
      return "an object {...} with one of " + quoted_list(kinds);
    }
    case Key::Kind::list: return "a list [...], where each item is " + allowed(key.keys.front());
    case Key::Kind::guess: {
      std::vector<std::string> names;
      for (const Key& guess : guess_keys()) names.push_back(guess.name);
      return "one of " + quoted_list(names) + ", or an object such as {\"oracle\": {\"error\": 0.1}}";
    }
    case Key::Kind::guesses: return "a list of guesses [...]";
  }
  throw std::logic_error("a kind of key without a description");
}

std::string describe(const Key& key) {
  return key.help + (key.unit.empty() ? "" : " [" + key.unit + "]") + ", " + allowed(key);
}

std::optional<nlohmann::ordered_json> preset_of(const Key& key, const std::string& tag_value) {
  const auto own = key.preset_for.find(tag_value);
  return own == key.preset_for.end() ? key.preset : own->second;
}

bool belongs(const Key& key, const std::string& tag_value) {
  return key.only_for.empty() || std::find(key.only_for.begin(), key.only_for.end(), tag_value) != key.only_for.end();
}

bool is_plausible(const Key& key, double value) {
  const double size = std::abs(value);
  return size == 0 || (size >= key.plausible->least && size <= key.plausible->most);
}

std::string other_unit(const Key& key, double value, double most) {
  struct Unit {
    const char* of;  ///< the key's unit
    const char* name;
    double size;
  };
  static constexpr Unit units[]{{"m", "mm", 1e-3},         {"m", "um", 1e-6},         {"Pa", "GPa", 1e9},
                                {"Pa", "MPa", 1e6},        {"Pa", "kPa", 1e3},        {"kg/m^3", "g/cm^3", 1e3},
                                {"kg/m^3", "g/m^3", 1e-3}, {"m/s^2", "mm/s^2", 1e-3}, {"m/s", "km/h", 1 / 3.6},
                                {"m/s", "mm/s", 1e-3},     {"s", "ms", 1e-3},         {"s", "us", 1e-6}};
  for (const Unit& unit : units)
    if (key.unit == unit.of && is_plausible(key, value * unit.size) && std::abs(value * unit.size) <= most)
      return fmt::format("; did you mean {:g} {}, which is {:g}?", value, unit.name, value * unit.size);
  return "";
}

const Key* find_key(const std::vector<Key>& keys, const std::string& name) {
  for (const Key& key : keys) {
    if (key.name == name || (!key.alias.empty() && key.alias == name)) return &key;
  }
  return nullptr;
}

}  // namespace rodsweep
