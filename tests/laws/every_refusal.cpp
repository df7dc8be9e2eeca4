// Every key of a job refuses what its row does not allow, with its path, the value and what is allowed: values of another
// kind or beyond a bound, also in sweeps; misspelt names; keys that belong to another kind of object; absent keys.
#include <cmath>
#include <set>

#include "tests/catch.hpp"
#include "tests/laws/key_places.hpp"

namespace rodsweep::laws {
namespace test_refusals {

using Catch::Matchers::ContainsSubstring;
using Kind = Key::Kind;

bool is_number(const Key& key) { return key.kind == Kind::number || key.kind == Kind::integer; }

/// Numbers just out of the bounds, on either side.
std::vector<Json> out_of_bounds(const Key& key) {
  std::vector<Json> values;
  if (std::isfinite(key.low)) values.push_back(number(key.above_low ? key.low : key.low - std::max(1., -key.low)));
  if (std::isfinite(key.high)) values.push_back(number(key.high + std::max(1., key.high)));
  return values;
}

/// Whether the row allows a value of this kind; its members and items are keys of their own.
bool takes(const Key& key, const Json& value) {
  if (value.is_string() && std::count(key.choices.begin(), key.choices.end(), value) > 0) return true;
  switch (key.kind) {
    case Kind::object: return value.is_object();
    case Kind::integer:
      if (value.is_number() && std::trunc(value.get<double>()) != value.get<double>()) return false;
      [[fallthrough]];
    case Kind::number:
      return value.is_number() && value <= key.high && (key.above_low ? value > key.low : value >= key.low);
    case Kind::boolean: return value.is_boolean();
    case Kind::text: return value.is_string() || (key.or_list && value.is_array() && !value.empty());
    case Kind::list:
    case Kind::guesses: return value.is_array();
    case Kind::variant: return value.is_object() && value.size() == 1;  // an unknown kind is an unknown key
    default: return false;                                              // none of the values here
  }
}

std::vector<Json> wrong_values(const Key& key) {
  std::vector<Json> values;
  for (const Json& value : Json::parse(R"([null, true, 2.5, "~", [], [1], {}, {"gird": [1, 2]}])"))
    if (!takes(key, value)) values.push_back(value);
  if (is_number(key))
    for (const Json& value : out_of_bounds(key)) values.push_back(value);
  if (key.kind == Kind::text && key.text != Key::Text::any)
    for (const std::string& text : {std::string(), std::string("a\nb"), std::string(std::size_t(key.high) + 1, 'a')})
      values.emplace_back(text);
  if (key.text == Key::Text::file_name)
    for (const char* text : {"a/b", "-x", "..", "a b"}) values.emplace_back(text);
  return values;
}

std::string shown(const Json& value) { return value.dump().substr(0, 50); }

TEST_CASE("a value that a key does not take is refused with its path, itself and what is allowed, also in sweeps") {
  int refused = 0;
  visit_keys([&](const KeyPlace& at) {
    const std::string must_be = "must be " + allowed(at.key);
    for (const Json& value : wrong_values(at.key)) {
      CAPTURE(at.path(), value.dump());
      CHECK_THAT(objection(at.with(value)),
                 ContainsSubstring(at.path() + ": " + shown(value)) && ContainsSubstring(must_be));
      if (!at.key.sweepable) continue;
      CHECK_THAT(objection(at.with({{"zip", {value}}})), ContainsSubstring(at.path() + ".zip[0]: " + shown(value)));
      ++refused;
    }
  });
  CHECK(refused > 1000);
}

TEST_CASE("a sweep that a key does not take is refused with its path and what is wrong with it") {
  visit_keys([&](const KeyPlace& at) {
    if (!at.key.sweepable) return;
    CAPTURE(at.path());
    const Json some = accepted(at, 1);
    CHECK_THAT(objection(at.with(grid(Json::array()))), ContainsSubstring(at.path() + ".grid: [] is not allowed"));
    CHECK_THAT(objection(at.with({{"grid", some}, {"zip", some}})),
               ContainsSubstring(at.path() + ": {\"grid\":") && ContainsSubstring("no key other than \"grid\""));
    const auto range = [&](const char* word, Json ends) { return objection(at.with({{word, std::move(ends)}})); };
    const std::string draws = at.path() + ".uniform: uniform draws ";
    if (!is_number(at.key)) {
      CHECK_THAT(range("uniform", {1, 2}), ContainsSubstring(draws + "a number") && ContainsSubstring(allowed(at.key)));
      return;
    }
    if (at.key.kind == Kind::integer)
      CHECK_THAT(range("uniform", {1, 2}), ContainsSubstring(draws + "fractional numbers"));
    const std::string word = at.key.kind == Kind::integer ? "integer" : "uniform", path = at.path() + "." + word;
    for (const Json& end : out_of_bounds(at.key))
      CHECK_THAT(range(word.c_str(), {end, end}),
                 ContainsSubstring(path + "[0]: " + shown(end)) && ContainsSubstring(path + "[1]: " + shown(end)));
    CHECK_THAT(range(word.c_str(), {1}), ContainsSubstring(path + ": [1] is not allowed; must be the two ends"));
  });
}

TEST_CASE("a mistyped word is refused with the nearest one") {
  visit_keys([&](const KeyPlace& at) {
    if (at.key.kind != Kind::choice || at.key.choices.size() < 2) return;
    for (const std::string& word : at.key.choices) {
      CAPTURE(at.path(), word);
      CHECK_THAT(objection(at.with(word + "~")), ContainsSubstring("did you mean \"" + word + "\"?"));
    }
  });
}

bool is_member(const KeyPlace& at) { return !std::isdigit(static_cast<unsigned char>(at.pointer.back())); }

/// The job with the key under another name.
Json renamed(const KeyPlace& at, const std::string& name) {
  Json job = at.job;
  const Json::json_pointer here(at.pointer);
  Json& around = job[here.parent_pointer()];
  around.erase(at.key.name);
  around[name] = nullptr;
  return job;
}

TEST_CASE("a misspelt name of a key, or another word for it, is refused with the name") {
  visit_keys([&](const KeyPlace& at) {
    if (!is_member(at) || at.key.kind == Kind::guess) return;
    std::vector<std::string> names = at.key.synonyms;
    if (at.key.name.size() > 3) names.push_back(at.key.name + "~");
    for (const std::string& name : names) {
      CAPTURE(at.path(), name);
      const std::string path = at.path().substr(0, at.path().size() - at.key.name.size()) + name;
      CHECK_THAT(objection(renamed(at, name)),
                 ContainsSubstring(path + ": unknown key; did you mean \"" + at.key.name + "\"?"));
    }
  });
}

TEST_CASE("a missing key is refused with its meaning, unit and what is allowed") {
  std::set<std::string> found;
  visit_keys([&](const KeyPlace& at) {
    const Json::json_pointer here(at.pointer);
    if (!is_member(at) || at.key.preset || !at.key.preset_for.empty() || !at.job.contains(here)) return;
    CAPTURE(at.path());
    const std::string refusal = objection(without(at.pointer, at.job));
    if (!at.key.alternative_group.empty())
      CHECK_THAT(refusal, ContainsSubstring("missing: the " + at.key.alternative_group + ", exactly one of"));
    else if (at.job[here.parent_pointer()].size() > 1 || at.key.kind != Kind::object)  // else a kind of obstacle
      CHECK_THAT(refusal, ContainsSubstring(at.path() + ": missing: " + describe(at.key)));
    found.insert(at.path());
  });
  CHECK(found.size() > 50);
}

TEST_CASE("a key of another kind of job, scene, solve, section, network or loss is refused with where it belongs") {
  std::map<std::string, std::vector<KeyPlace>> by_object;  // those that belong to some kinds only
  visit_keys([&](const KeyPlace& at) {
    if (!at.key.only_for.empty()) by_object[Json::json_pointer(at.pointer).parent_pointer().to_string()].push_back(at);
  });
  std::set<std::string> tried;
  for (const auto& [object, places] : by_object)
    for (const KeyPlace& at : places)
      for (const KeyPlace& other : places) {
        std::string words, others;
        for (const std::string& word : at.key.only_for) words += (words.empty() ? "\"" : " or \"") + word + '"';
        for (const std::string& word : other.key.only_for) others += word;
        const auto is_shared = [&](const std::string& word) { return belongs(other.key, word); };
        if (std::any_of(at.key.only_for.begin(), at.key.only_for.end(), is_shared)) continue;
        if (!tried.insert(at.path() + others).second) continue;
        CAPTURE(at.path(), other.path());
        Json job = other.job;
        job[Json::json_pointer(at.pointer)] = nullptr;
        CHECK_THAT(objection(job), ContainsSubstring(at.path() + ": this key belongs to ") &&
                                       ContainsSubstring(' ' + words + ", not to \"") &&
                                       ContainsSubstring(at.key.only_advice));
      }
  CHECK(tried.size() > 100);
}

}  // namespace test_refusals
}  // namespace rodsweep::laws
