// Every key is described, and the JSON Schema follows the table of keys. tests/command/test_schema.py checks the committed schema against the
// reader with a real validator.

#include "runner/keys/key.hpp"
#include "tests/catch.hpp"
#include "tests/runner/job_examples.hpp"

using namespace rodsweep;

TEST_CASE("every key of a job has a property with its help and default, or is required") {
  const Json schema = job_schema();
  for (const Key& key : job_key().keys) {
    CAPTURE(key.name);
    const Json& property = schema["properties"][key.name];
    CHECK(property["description"].get<std::string>().find(key.help) == 0);
    const Json& required = schema["required"];
    const bool is_required = std::find(required.begin(), required.end(), key.name) != required.end();
    CHECK(is_required == (!key.preset && key.only_for.empty()));
    if (key.preset && !key.preset->is_object()) CHECK(property["default"] == *key.preset);
  }
  CHECK(schema["additionalProperties"] == false);
}

TEST_CASE("what only some kinds of job have is required there and refused elsewhere") {
  const Json rules = job_schema()["allOf"];
  for (const Key& key : job_key().keys) {
    CAPTURE(key.name);
    for (const Json& rule : rules) {
      const std::string kind = rule["if"]["properties"]["kind"]["const"];
      const Json& required = rule["then"]["required"];
      const bool is_required = std::find(required.begin(), required.end(), key.name) != required.end();
      CHECK(is_required == (!key.preset && !key.only_for.empty() && belongs(key, kind)));
      CHECK((rule["then"]["properties"].value(key.name, Json()) == false) == !belongs(key, kind));
    }
  }
}

TEST_CASE("every guess has a definition, a name alone where nothing is required") {
  const Json guess = job_schema()["definitions"]["guess"]["anyOf"];
  for (const Key& key : guess_keys()) CHECK(guess[1]["properties"].contains(key.name));
  const Json& names = guess[0]["enum"];
  CHECK(std::find(names.begin(), names.end(), "oracle") != names.end());
  CHECK(std::find(names.begin(), names.end(), "guarded") == names.end());
}

/// Calls check(key) for a key and all keys within it.
template <class Check>
void for_every_key(const Key& key, const Check& check) {
  check(key);
  for (const Key& child : key.keys) for_every_key(child, check);
}

TEST_CASE("every key is described") {
  const auto check = [](const Key& key) {
    INFO(key.name);
    CHECK_FALSE(key.name.empty());
    CHECK_FALSE(key.help.empty());
    CHECK_FALSE(allowed(key).empty());
    if (key.kind == Key::Kind::choice) CHECK_FALSE(key.choices.empty());
    const bool has_unit_suffix = (key.name.size() > 2 && key.name.find("_m") == key.name.size() - 2) ||
                                 key.name.find("_pa") != std::string::npos;
    if (has_unit_suffix) CHECK_FALSE(key.unit.empty());
    if (!key.tag.empty()) CHECK(find_key(key.keys, key.tag) != nullptr);
  };
  for_every_key(job_key(), check);
  for (const Key& guess : guess_keys()) for_every_key(guess, check);
  check(guess_label_key());
}

TEST_CASE("the text is the schema, whole") { CHECK(Json::parse(job_schema_text()) == job_schema()); }
