// The functions of JobReader that read objects and lists, especially guesses.
#include <fmt/format.h>

#include <cmath>
#include <map>

#include "runner/keys/job_reader.hpp"
#include "runner/keys/key.hpp"
#include "runner/keys/sweep_words.hpp"
#include "runner/text/job_error.hpp"
#include "runner/text/words.hpp"

namespace rodsweep {
namespace {

using Json = nlohmann::ordered_json;

/// "oracle 0.1", "oracle 0.1 smooth": the name and the unswept parameters, without words that are defaults.
std::string default_label(const std::string& name, const Json& parameters) {
  std::string label = name;
  const std::vector<Key>& keys = find_key(guess_keys(), name)->keys;
  for (const auto& [key, value] : parameters.items()) {
    if (key == guess_label_key().name || !sweep_word(value).empty()) continue;
    const Key* described = find_key(keys, key);
    if (!described->labelled || ((value.is_string() || !described->labelled_as_preset) && described->preset == value))
      continue;
    if (value.is_object() && !value.empty()) {
      label += " " + default_label(value.begin().key(), value.begin().value());
    } else if (described->text == Key::Text::path) {
      label += " " + std::filesystem::path(value.get<std::string>()).stem().native();
    } else {
      if (!described->label_word.empty()) label += " " + described->label_word;
      label += " " + (value.is_string() ? value.get<std::string>() : value.dump());
    }
  }
  return label;
}

/// "previous | oracle 0.1": all options of a guess that varies over the tasks.
std::string varying_label(const Json& guess) {
  const std::string word = sweep_word(guess);
  if (word.empty()) return default_label(guess.begin().key(), guess.begin().value());
  std::string label;
  for (const Json& option : guess[word]) label += (label.empty() ? "" : " | ") + varying_label(option);
  return label;
}

/// A valid value for the key: `given` if valid.
Json example_value(const Key& key, const Json& given) {
  switch (key.kind) {
    case Key::Kind::integer:
    case Key::Kind::number: {
      const double wanted = given.is_number() ? given.get<double>() : NAN;
      return fits(key, wanted) ? number(wanted) : key.preset.value_or(Json(1));
    }
    case Key::Kind::choice: return key.preset.value_or(Json(key.choices.front()));
    case Key::Kind::text: return given.is_string() && !given.empty() ? given : Json("FILE.h5");
    case Key::Kind::guess: return given.is_string() && find_key(guess_keys(), given) ? given : Json("previous");
    default: return Json();
  }
}

/// In the order of the keys, so that tasks do not depend on that of the job's lines.
Json ordered(const std::vector<Key>& keys, Json& object) {
  Json result = Json::object();
  for (const Key& key : keys)
    if (object.contains(key.name)) result[key.name] = std::move(object[key.name]);
  return result;
}

/// An example of a guess with its required parameters; if none is required, with its first one.
Json guess_example(const Key& guess, const Json& given) {
  Json parameters = Json::object();
  for (const Key& key : guess.keys)
    if (!key.preset) parameters[key.name] = example_value(key, given);
  if (parameters.empty() && !guess.keys.empty())
    parameters[guess.keys.front().name] = example_value(guess.keys.front(), given);
  return Json{{guess.name, parameters}};
}

/// {"subspace": {"size": 10}}, with spaces.
std::string spaced(const Json& object) {
  std::string text;
  for (const auto& [name, value] : object.items())
    text +=
        fmt::format("{}\"{}\": {}", text.empty() ? "" : ", ", name, value.is_object() ? spaced(value) : value.dump());
  return "{" + text + "}";
}

}  // namespace

bool JobReader::applies(const Key& key) const { return tag_.value.empty() || belongs(key, tag_.value); }

JobReader::Tag JobReader::tag_of(const Key& key, const Json& value, const std::string& path) {
  Tag tag{member(path, key.tag), ""};
  const Key& decides = *find_key(key.keys, key.tag);
  const Json given = value.contains(key.tag) ? value[key.tag] : decides.preset.value_or(Json());
  for (const std::string& choice : decides.choices) {
    if (given == choice) tag.value = choice;
  }
  return tag;
}

Json JobReader::read_object(const Key& key, const Json& value, const std::string& path) {
  if (!value.is_object()) return refuse(key, value, path);
  const Tag outer = tag_;
  if (!key.tag.empty()) tag_ = tag_of(key, value, path);
  Json result = Json::object();
  for (const auto& [name, child] : value.items()) {
    const Key* child_key = find_key(key.keys, name);
    if (!child_key || !applies(*child_key))
      refuse_unknown(key, name, path);
    else if (result.contains(child_key->name))
      mistake(member(path, name), "\"{}\" and \"{}\" are the same key; give only one", child_key->name,
              child_key->alias);
    else
      result[child_key->name] = read(*child_key, child, member(path, name));
  }
  fill_absent(key, path, result);
  tag_ = outer;
  return ordered(key.keys, result);
}

Json JobReader::read_variant(const Key& key, const Json& value, const std::string& path) {
  if (!value.is_object() || value.size() != 1) return refuse(key, value, path);
  const std::string& kind = value.begin().key();
  if (const Key* found = find_key(key.keys, kind))
    return Json{{kind, read(*found, value.begin().value(), member(path, kind))}};
  refuse_unknown(key, kind, path);
  return value;
}

Json JobReader::read_list(const Key& key, const Json& value, const std::string& path) {
  if (!value.is_array()) return refuse(key, value, path);
  return read_items(key.keys.front(), value, path);
}

Json JobReader::read_items(const Key& item, const Json& values, const std::string& path) {
  Json result = Json::array();
  for (std::size_t i = 0; i < values.size(); ++i) result.push_back(read(item, values[i], element(path, i)));
  return result;
}

void JobReader::refuse_unknown(const Key& key, const std::string& name, const std::string& path) {
  if (const Key* other = find_key(key.keys, name)) {
    mistake(member(path, name), "this key belongs to {} {}, not to \"{}\"{}{}", tag_.path,
            quoted_list(other->only_for, " or "), tag_.value, other->only_advice.empty() ? "" : "; ",
            other->only_advice);
    return;
  }
  std::vector<std::string> known, words;
  std::map<std::string, std::string> meant;
  for (const Key& child : key.keys) {
    if (!applies(child)) continue;
    known.push_back(child.name);
    words.push_back(child.name);
    meant[child.name] = child.name;
    for (const std::string& synonym : child.synonyms) {
      words.push_back(synonym);
      meant[synonym] = child.name;
    }
  }
  const std::string near = nearest(name, words);
  const std::string hint = near.empty()
                               ? (known.empty() ? "no keys are allowed here" : "allowed here: " + quoted_list(known))
                               : "did you mean \"" + meant[near] + "\"?";
  mistake(member(path, name), "unknown key; " + hint);
}

void JobReader::fill_absent(const Key& key, const std::string& path, Json& result) {
  std::map<std::string, std::vector<const Key*>> groups;
  for (const Key& child : key.keys) {
    if (!belongs(child, tag_.value)) continue;
    if (!child.alternative_group.empty()) {
      groups[child.alternative_group].push_back(&child);
    } else if (result.contains(child.name)) {
      continue;
    } else if (const auto preset = preset_of(child, tag_.value)) {
      result[child.name] = read(child, *preset, member(path, child.name));
    } else {
      mistake(member(path, child.name), "missing: " + describe(child));
    }
  }
  for (const auto& [group, members] : groups) {
    std::vector<std::string> given, all;
    for (const Key* child : members) {
      all.push_back(child->name);
      if (result.contains(child->name)) given.push_back(child->name);
    }
    if (given.empty()) {
      mistake(path, "missing: the {}, exactly one of {}", group, quoted_list(all));
    } else if (given.size() > 1) {
      mistake(path, "{} exclude each other; give exactly one", quoted_list(given));
    }
  }
}

Json JobReader::read_guess(const Key& key, const Json& value, const std::string& path, bool labelled) {
  std::string name;
  Json given = Json::object();
  if (value.is_string()) {
    name = value;
  } else if (value.is_object() && value.size() == 1) {
    name = value.begin().key();
    given = value.begin().value();
  } else {
    const bool label_outside = value.is_object() && value.contains("label");
    refuse(key, value, path, label_outside ? "; put the label inside: {\"previous\": {\"label\": \"...\"}}" : "");
    return value;
  }
  const Key* guess = find_key(guess_keys(), name);
  if (!guess) return refuse(key, value, path, did_you_mean(name, names(guess_keys())));
  Key keys = *guess;
  if (labelled) keys.keys.push_back(Key(guess_label_key()).defaults_to(name));
  if (!given.is_object()) {
    refuse(keys, given, member(path, name),
           guess->keys.empty() ? fmt::format("; \"{}\" has no parameters: write only its name", name)
                               : " with its parameters; for example " + spaced(guess_example(*guess, given)));
    return value;
  }
  const std::size_t before = mistakes_;
  Json parameters = read_object(keys, given, member(path, name));
  const bool sound = mistakes_ == before;  // else the parameters may be invalid
  if (labelled && sound && !given.contains("label")) parameters["label"] = default_label(name, parameters);
  return Json{{name, std::move(parameters)}};
}

Json JobReader::read_varying_guess(const Key& key, Json sweep, std::size_t index, const std::string& path) {
  const Key& label_key = guess_label_key();
  Json label;
  if (sweep.contains(label_key.name)) {
    label = read(label_key, sweep[label_key.name], member(path, label_key.name));
    sweep.erase(label_key.name);
  }
  const std::size_t before = mistakes_;
  Json result = read_sweep(key, sweep, path);
  if (mistakes_ != before) return result;
  if (label.is_null()) {
    label = varying_label(result);
    if (static_cast<double>(label.get_ref<const std::string&>().size()) > label_key.high) {
      label = fmt::format("varying guess {}", index);
    }
  }
  result[label_key.name] = std::move(label);
  return result;
}

Json JobReader::read_guesses(const Json& value, const std::string& path) {
  const Key guess = guess_key("guess", "initial guess of cg");
  if (!value.is_array()) return refuse(guesses_key("guesses", ""), value, path);
  Json result = Json::array();
  std::map<std::string, std::size_t> labels;
  for (std::size_t i = 0; i < value.size(); ++i) {
    const std::size_t before = mistakes_;
    result.push_back(sweep_word(value[i]).empty() ? read_guess(guess, value[i], element(path, i), true)
                                                  : read_varying_guess(guess, value[i], i, element(path, i)));
    if (mistakes_ != before) continue;
    const std::string label = guess_label(result.back());
    const auto [first, is_new] = labels.emplace(label, i);
    if (!is_new) {
      mistake(element(path, i), "its label \"{}\" is also the label of {}; give one of them another \"label\"", label,
              element(path, first->second));
    }
  }
  return result;
}

}  // namespace rodsweep
