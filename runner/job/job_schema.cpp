#include "runner/job/job_schema.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>

#include "runner/job/guess_keys.hpp"
#include "runner/job/job_keys.hpp"
#include "runner/job/sweep.hpp"
#include "runner/text/key_path.hpp"

namespace rodsweep {
namespace {

using Json = nlohmann::ordered_json;

Json reference(const std::string& definition) { return {{"$ref", "#/definitions/" + definition}}; }

std::string description(const Key& key) { return key.help + (key.unit.empty() ? "" : " [" + key.unit + "]"); }

Json bounded(const char* type, const Key& key) {
  Json schema{{"type", type}};
  if (std::isfinite(key.low)) schema[key.above_low ? "exclusiveMinimum" : "minimum"] = number(key.low);
  if (std::isfinite(key.high)) schema["maximum"] = number(key.high);
  return schema;
}

Json object_of(const std::string& word, Json value) {
  return {{"type", "object"},
          {"properties", {{word, std::move(value)}}},
          {"required", Json::array({word})},
          {"additionalProperties", false}};
}

Json exactly_one(Json properties) {
  return {{"type", "object"},
          {"properties", std::move(properties)},
          {"minProperties", 1},
          {"maxProperties", 1},
          {"additionalProperties", false}};
}

class SchemaWriter {
 public:
  Json write() {
    Json job = object(job_key(), "");
    Json schema{{"$schema", "http://json-schema.org/draft-07/schema#"},
                {"title", "rodsweep job"},
                {"$comment", "made by `rodsweep schema` from the table that the program reads jobs with"}};
    schema.update(job);
    schema["definitions"] = Json::object();
    for (auto& [name, definition] : definitions_) schema["definitions"][name] = definition;
    return schema;
  }

 private:
  /// The schema at a key: its value or, if sweepable, also a sweep.
  Json place(const Key& key, const std::string& path) {
    Json schema;
    if (key.kind == Key::Kind::guess) {
      schema = guess(false);
    } else if (!key.sweepable) {
      schema = value(key, path);
    } else {
      define(path, key, path);
      schema = reference(path);
    }
    // Draft-07 ignores all keys beside a $ref.
    if (schema.contains("$ref")) schema = Json{{"allOf", Json::array({schema})}};
    if (!schema.contains("description")) schema["description"] = description(key);
    if (key.preset && !key.preset->is_object()) schema["default"] = *key.preset;
    return schema;
  }

  void define(const std::string& name, const Key& key, const std::string& path) {
    if (!definitions_.emplace(name, Json()).second) return;
    Json alternatives = Json::array({value(key, path)});
    append_sweeps(key, reference(name), alternatives);
    definitions_[name] = {{"anyOf", alternatives}};
  }

  static void append_sweeps(const Key& key, const Json& item, Json& alternatives) {
    const bool numeric = key.kind == Key::Kind::integer || key.kind == Key::Kind::number;
    for (const std::string& word : sweep_words()) {
      if (is_listed(word)) {
        alternatives.push_back(object_of(word, {{"type", "array"}, {"items", item}, {"minItems", 1}}));
      } else if (word == "integer" ? numeric : key.kind == Key::Kind::number) {
        Json end = bounded(word == "integer" ? "integer" : "number", key);
        if (word == "log_uniform" && !(key.low > 0)) {
          end.erase("minimum");
          end["exclusiveMinimum"] = 0;
        }
        alternatives.push_back(object_of(word, {{"type", "array"}, {"items", end}, {"minItems", 2}, {"maxItems", 2}}));
      }
    }
  }

  /// The schema of a value without a sweep.
  Json value(const Key& key, const std::string& path) {
    if (key.or_list) {
      const Json item = value(item_key(key), path);
      return {{"anyOf", Json::array({item, Json{{"type", "array"}, {"items", item}, {"minItems", 1}}})}};
    }
    switch (key.kind) {
      case Key::Kind::object: return or_words(object(key, path), key);
      case Key::Kind::integer: return bounded("integer", key);
      case Key::Kind::boolean: return {{"type", "boolean"}};
      case Key::Kind::number: return or_words(bounded("number", key), key);
      case Key::Kind::vector: {
        const std::string name = path + ".component";
        define(name, component_key(key), path);
        return {{"type", "array"}, {"items", reference(name)}, {"minItems", 3}, {"maxItems", 3}};
      }
      case Key::Kind::text: return text(key);
      case Key::Kind::choice: return {{"enum", key.choices}};
      case Key::Kind::variant: return variant(key, path);
      case Key::Kind::list: return {{"type", "array"}, {"items", place(key.keys.front(), path + ".item")}};
      case Key::Kind::guess: return guess(false);
      case Key::Kind::guesses: return {{"type", "array"}, {"items", guess(true)}};
    }
    throw std::logic_error("a kind of key without a schema");
  }

  static Json or_words(Json plain, const Key& key) {
    return key.choices.empty() ? plain : Json{{"anyOf", Json::array({plain, Json{{"enum", key.choices}}})}};
  }

  static Json text(const Key& key) {
    Json schema{{"type", "string"}};
    if (std::isfinite(key.high)) schema["maxLength"] = number(key.high);
    if (key.text == Key::Text::line) schema["pattern"] = "^[^\\u0000-\\u001f\\u007f]+$";
    if (key.text == Key::Text::file_name) schema["pattern"] = "^[A-Za-z0-9_][A-Za-z0-9_.-]*$";
    return schema;
  }

  /// Properties, required keys and, for each value of the tag, the allowed and forbidden keys.
  Json object(const Key& key, const std::string& path) {
    Json properties = Json::object(), required = Json::array();
    std::map<std::string, Json> groups;
    for (const Key& child : key.keys) {
      properties[child.name] = place(child, member(path, child.name));
      const auto one_of = [&](const std::string& group, const std::string& name) {
        groups[group].push_back(Json{{"required", Json::array({name})}});
      };
      if (!child.alias.empty()) {
        properties[child.alias] = properties[child.name];
        properties[child.alias]["description"] = "the same as " + child.name;
        for (const std::string& name : {child.name, child.alias}) one_of(child.name, name);
      } else if (!child.alternative_group.empty()) {
        one_of(child.alternative_group, child.name);
      } else if (!child.preset && child.only_for.empty()) {
        required.push_back(child.name);
      }
    }
    Json schema{{"type", "object"}, {"properties", properties}, {"additionalProperties", false}};
    if (!required.empty()) schema["required"] = required;
    Json rules = Json::array();
    for (const auto& [name, alternatives] : groups) rules.push_back(Json{{"oneOf", alternatives}});
    if (!key.tag.empty())
      for (const std::string& tag_value : find_key(key.keys, key.tag)->choices) append_rule(key, tag_value, rules);
    if (!rules.empty()) schema["allOf"] = rules;
    return schema;
  }

  Json variant(const Key& key, const std::string& path) {
    Json properties = Json::object();
    for (const Key& kind : key.keys) properties[kind.name] = place(kind, member(path, kind.name));
    return exactly_one(std::move(properties));
  }

  static void append_rule(const Key& key, const std::string& tag_value, Json& rules) {
    Json required = Json::array();
    for (const Key& child : key.keys) {
      if (!child.only_for.empty() && belongs(child, tag_value) && !child.preset && child.alternative_group.empty())
        required.push_back(child.name);
    }
    Json properties = refusals(key, tag_value);
    for (const Key& child : key.keys)
      if (const auto own = child.preset_for.find(tag_value); own != child.preset_for.end())
        properties[child.name] = {{"default", own->second}};
    if (required.empty() && properties.empty()) return;
    Json condition{{"properties", {{key.tag, {{"const", tag_value}}}}}};
    if (find_key(key.keys, key.tag)->preset != tag_value) condition["required"] = Json::array({key.tag});
    rules.push_back({{"if", condition}, {"then", {{"required", required}, {"properties", properties}}}});
  }

  /// Forbids the keys of other values of the tag, also in nested objects without a tag.
  static Json refusals(const Key& key, const std::string& tag_value) {
    Json refused = Json::object();
    for (const Key& child : key.keys) {
      if (!belongs(child, tag_value)) {
        refused[child.name] = false;
      } else if (child.kind == Key::Kind::object && child.tag.empty()) {
        if (Json within = refusals(child, tag_value); !within.empty())
          refused[child.name] = {{"properties", std::move(within)}};
      }
    }
    return refused;
  }

  static Json label() {
    Json schema = text(guess_label_key());
    schema["description"] = description(guess_label_key());
    return schema;
  }

  /// A name if no parameter is required, an object with the name as its only key, or a sweep of these. Entries of the
  /// list of guesses may have a label, beside the word of a sweep; swept and inner guesses have none.
  Json guess(bool labelled) {
    const std::string name = labelled ? "guess" : "inner_guess";
    if (!definitions_.emplace(name, Json()).second) return reference(name);
    Json words = Json::array(), properties = Json::object();
    for (const Key& key : guess_keys()) {
      properties[key.name] = object(key, "guess." + key.name);
      properties[key.name]["description"] = description(key);
      if (labelled) properties[key.name]["properties"][guess_label_key().name] = label();
      bool complete = true;
      for (const Key& parameter : key.keys) complete = complete && parameter.preset;
      if (complete) words.push_back(key.name);
    }
    Json alternatives = Json::array({Json{{"enum", words}}, exactly_one(std::move(properties))});
    const std::size_t plain = alternatives.size();
    append_sweeps(guess_key("guess", ""), labelled ? guess(false) : reference(name), alternatives);
    for (std::size_t i = plain; labelled && i < alternatives.size(); ++i)
      alternatives[i]["properties"][guess_label_key().name] = label();
    definitions_[name] = {{"description", "initial guess of cg"}, {"anyOf", alternatives}};
    return reference(name);
  }

  std::map<std::string, Json> definitions_;
};

}  // namespace

Json job_schema() { return SchemaWriter().write(); }

std::string job_schema_text() {
  const Json schema = job_schema();
  std::string text = "{";
  const auto entry = [&](const char* before, const std::string& name, const Json& value) {
    text += fmt::format("{}{}: {}", before, Json(name).dump(), value.dump());
  };
  for (const auto& [name, value] : schema.items()) {
    const bool parts = name == "properties" || name == "definitions";
    entry(text.size() > 1 ? ",\n" : "\n", name, parts ? Json::object() : value);
    if (!parts) continue;
    text.pop_back();
    for (const auto& [part, content] : value.items()) entry(text.back() == '{' ? "\n  " : ",\n  ", part, content);
    text += "\n}";
  }
  return text + "\n}\n";
}

}  // namespace rodsweep
