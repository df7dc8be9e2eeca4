#include "runner/keys/key.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rodsweep {
namespace {

Key make(Key::Kind kind, const char* name, const char* help) {
  return Key().set(&Key::kind, kind).set(&Key::name, name).set(&Key::help, help);
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

Key object_key(const char* name, const char* help, std::vector<Key> keys, const char* tag) {
  return make(Key::Kind::object, name, help).set(&Key::keys, std::move(keys)).set(&Key::tag, tag);
}
Key integer_key(const char* name, const char* help) { return make(Key::Kind::integer, name, help); }
Key boolean_key(const char* name, const char* help) { return make(Key::Kind::boolean, name, help); }
Key number_key(const char* name, const char* help) { return make(Key::Kind::number, name, help); }
Key vector_key(const char* name, const char* help) { return make(Key::Kind::vector, name, help); }
Key text_key(const char* name, const char* help) { return make(Key::Kind::text, name, help); }
Key file_key(const char* name, FileKind kind, const char* help) {
  return text_key(name, help).at_most(4095).of_form(Key::Text::path).set(&Key::file, kind);
}
Key choice_key(const char* name, const char* help, std::vector<std::string> choices) {
  return make(Key::Kind::choice, name, help).set(&Key::choices, std::move(choices));
}
Key variant_key(const char* name, const char* help, std::vector<Key> kinds) {
  return make(Key::Kind::variant, name, help).set(&Key::keys, std::move(kinds));
}
Key list_key(const char* name, const char* help, Key item) {
  return make(Key::Kind::list, name, help).set(&Key::keys, std::vector<Key>{std::move(item)});
}
Key guess_key(const char* name, const char* help) { return make(Key::Kind::guess, name, help); }
Key guesses_key(const char* name, const char* help) { return make(Key::Kind::guesses, name, help); }

Key item_key(const Key& listed) { return Key(listed).set(&Key::or_list, false); }

Key component_key(const Key& vector) { return Key(vector).set(&Key::kind, Key::Kind::number); }

nlohmann::ordered_json number(double value) {
  if (std::trunc(value) == value && std::abs(value) <= 9007199254740991) return static_cast<std::int64_t>(value);
  return value;
}

std::vector<std::string> names(const std::vector<Key>& keys) {
  std::vector<std::string> result;
  for (const Key& key : keys) result.push_back(key.name);
  return result;
}

std::string quoted_list(const std::vector<std::string>& words, const char* separator) {
  std::string text;
  for (const std::string& word : words) text += fmt::format("{}\"{}\"", text.empty() ? "" : separator, word);
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
    case Key::Kind::variant: return "an object {...} with one of " + quoted_list(names(key.keys));
    case Key::Kind::list: return "a list [...], where each item is " + allowed(key.keys.front());
    case Key::Kind::guess:
      return "one of " + quoted_list(names(guess_keys())) + ", or an object such as {\"oracle\": {\"error\": 0.1}}";
    case Key::Kind::guesses: return "a list of guesses [...]";
  }
  throw std::logic_error("a kind of key without a description");
}

std::string describe(const Key& key) {
  return key.help + (key.unit.empty() ? "" : " [" + key.unit + "]") + ", " + allowed(key);
}

std::optional<nlohmann::ordered_json> preset_of(const Key& key, const std::string& tag_value) {
  const auto own = key.preset_for.find(tag_value);
  return own == key.preset_for.end() ? key.preset : std::optional(own->second);
}

bool belongs(const Key& key, const std::string& tag_value) {
  return key.only_for.empty() || std::find(key.only_for.begin(), key.only_for.end(), tag_value) != key.only_for.end();
}

bool fits(const Key& key, double value) {
  return std::isfinite(value) && value <= key.high && (key.above_low ? value > key.low : value >= key.low) &&
         (key.kind != Key::Kind::integer || std::trunc(value) == value);
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
