// The description of one key of a job file. Reading, defaults, errors, columns of the results file and help texts are
// derived from it. job_keys.cpp has the root; key_table.hpp binds keys to the members that they fill.
#pragma once

#include <nlohmann/json.hpp>

#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "runner/inputs/input_file.hpp"

namespace rodsweep {

struct Key {
  enum class Kind {
    object,   ///< with the members `keys`; or one of `choices`, a word that means no object
    integer,  ///< within [low, high]
    boolean,  ///< true or false
    number,   ///< finite, within the bounds; or one of `choices`, a word instead of a number
    vector,   ///< three numbers, each within the bounds
    text,     ///< 1 to `high` bytes with the form `text`
    choice,   ///< one of `choices`
    variant,  ///< an object with exactly one of `keys`, which is its kind; the value is an object with its members
    list,     ///< a list, maybe empty, of values of the single key in `keys`
    guess,    ///< a name of guess_keys(), or an object with that name as its only key and the parameters as value
    guesses   ///< a list of guesses with unique labels
  };

  enum class Text {
    any,       ///< may be empty
    line,      ///< no control characters
    path,      ///< of an existing file, relative to the job file
    file_name  ///< letters, digits, "_", "-" and "."; does not begin with "-" or "."
  };

  /// Where the magnitudes of real things lie, or 0. A value outside is warned of, not refused.
  struct Plausible {
    double least, most;
    std::string known;  ///< to compare with: "water has 1000", or ""
  };

  std::string name;
  Kind kind = Kind::object;
  std::string unit;  ///< SI; may be empty
  std::string help;  ///< one line

  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool above_low = false;  ///< `low` itself is excluded
  std::optional<Plausible> plausible;
  std::vector<std::string> choices;
  Text text = Text::any;
  FileKind file = FileKind::any;                             ///< of a path
  std::optional<nlohmann::ordered_json> preset;              ///< default; none: the key is required
  std::map<std::string, nlohmann::ordered_json> preset_for;  ///< other defaults, by value of the enclosing `tag`
  bool labelled = true;                                      ///< guess parameter: whether it is part of the label
  bool labelled_as_preset = true;                            ///< also if it has its default value
  std::string label_word;                                    ///< the word before its value in a label
  bool sweepable = true;                                     ///< whether its value may be a sweep
  bool parameter = true;                                     ///< a parameter of tasks, not a setting of the whole job
  bool or_list = false;                                      ///< also accepts a list of one or more such values
  std::string no_sweep_advice;                               ///< advice if a user sweeps it
  std::string alias;                                         ///< another accepted name, or ""
  std::vector<std::string> synonyms;                         ///< suggested, but not accepted
  std::vector<std::string> only_for;                         ///< values of the nearest `tag` with this key; empty: all
  std::string only_advice;                                   ///< advice if the tag has another value
  std::string alternative_group;  ///< exactly one of the keys with the same group must be given

  /// With "sampling" "sobol": its dimension of Sobol's sequence, of no other key, fixed for ever. None: random directions.
  std::optional<int> sobol_dimension;

  std::string tag;        ///< object: the member whose value determines which `only_for` members apply
  std::vector<Key> keys;  ///< object: its members; variant: the kinds; list: the key of an item

  template <class Value, class Given>
  Key& set(Value Key::*member, Given&& value) {
    this->*member = std::forward<Given>(value);
    return *this;
  }
  Key& in(const char* si_unit) { return set(&Key::unit, si_unit); }
  Key& above(double bound) { return set(&Key::low, bound).set(&Key::above_low, true); }
  Key& at_least(double bound) { return set(&Key::low, bound).set(&Key::above_low, false); }
  Key& at_most(double bound) { return set(&Key::high, bound); }
  Key& from(double least, double most) { return at_least(least).at_most(most); }
  Key& positive(double most) { return above(0).at_most(most); }
  Key& plausibly(double least, double most, const char* known = "") {
    return set(&Key::plausible, Plausible{least, most, known});
  }
  Key& or_word(const char* word) { return set(&Key::choices, std::vector<std::string>{word}); }
  Key& defaults_to(nlohmann::ordered_json value) { return set(&Key::preset, std::move(value)); }
  Key& only(std::vector<std::string> tag_values, const char* advice = "") {
    return set(&Key::only_for, std::move(tag_values)).otherwise(advice);
  }
  Key& otherwise(const char* advice) { return set(&Key::only_advice, advice); }  ///< a KeyTable sets only_for
  Key& one_of_group(const char* group) { return set(&Key::alternative_group, group); }
  Key& of_form(Text form) { return set(&Key::text, form); }
  Key& also_accepted_as(const char* name_too) { return set(&Key::alias, name_too); }
  Key& also_called(std::vector<std::string> words) { return set(&Key::synonyms, std::move(words)); }
  Key& unswept(const char* advice = "") { return set(&Key::sweepable, false).set(&Key::no_sweep_advice, advice); }
  Key& or_list_of_such() { return set(&Key::or_list, true); }
  Key& unlabelled() { return set(&Key::labelled, false); }
  Key& on_sobol(int dimension) { return set(&Key::sobol_dimension, dimension); }
  Key& labelled_if_changed(const char* word = "") {  ///< "word value"
    return set(&Key::labelled_as_preset, false).set(&Key::label_word, word);
  }
  /// Of the whole job: neither swept nor a parameter of tasks.
  Key& setting() { return set(&Key::sweepable, false).set(&Key::parameter, false); }
};

Key object_key(const char* name, const char* help, std::vector<Key> keys = {}, const char* tag = "");
Key integer_key(const char* name, const char* help);
Key boolean_key(const char* name, const char* help);
Key number_key(const char* name, const char* help);
Key vector_key(const char* name, const char* help);
Key text_key(const char* name, const char* help);
Key file_key(const char* name, FileKind kind, const char* help);
Key choice_key(const char* name, const char* help, std::vector<std::string> choices = {});
Key variant_key(const char* name, const char* help, std::vector<Key> kinds);
Key list_key(const char* name, const char* help, Key item);
Key guess_key(const char* name, const char* help);
Key guesses_key(const char* name, const char* help);

/// The key of one value of a list allowed by `or_list`.
Key item_key(const Key& listed);

/// The key of one component of a vector.
Key component_key(const Key& vector);

/// The allowed values, as text after "must be": "an integer from 1 to 1000000", "one of "none", "jacobi"".
std::string allowed(const Key& key);

/// "clamped length [m], a number above 0".
std::string describe(const Key& key);

/// Member by name or alias, nullptr if there is none.
const Key* find_key(const std::vector<Key>& keys, const std::string& name);

/// Whether a key applies for this value of the tag.
bool belongs(const Key& key, const std::string& tag_value);

/// The default value.
std::optional<nlohmann::ordered_json> preset_of(const Key& key, const std::string& tag_value);

/// Whether a number is finite, within the bounds, and whole if those of the key are.
bool fits(const Key& key, double value);

/// Whether a value is 0 or in the plausible range, which the key must have.
bool is_plausible(const Key& key, double value);

/// "; did you mean 50 mm, which is 0.05?" if the value is plausible in another unit and at most `most` there.
std::string other_unit(const Key& key, double value, double most);

/// A number as written in a job: 1 instead of 1.0.
nlohmann::ordered_json number(double value);

std::vector<std::string> names(const std::vector<Key>& keys);
/// "a", "b", "c"
std::string quoted_list(const std::vector<std::string>& words, const char* separator = ", ");

// The tables of keys that the reader, the schema and the space of a sweep follow. Their rows are in runner/specs.

/// The key of the whole job: an object whose `kind` determines its other keys.
const Key& job_key();

/// One object key per kind of guess, with its parameters.
const std::vector<Key>& guess_keys();

/// `label`, allowed in any entry of the list of guesses, beside its parameters or its sweep.
const Key& guess_label_key();

// A JSON Schema of job files (draft-07, which editors support best), generated from the reader's table of keys, in
// job_schema.cpp. It covers names, types, bounds, words, defaults, units, related keys, and sweeps. Only the reader
// checks conditions on several values: equal lengths of zips, "zero" among the guesses, unique labels, ascending
// ranges.

nlohmann::ordered_json job_schema();

/// The output of `rodsweep schema` and the content of jobs/schema.json: a line per keyword, key of the job and definition.
/// `more`: keywords that validators ignore.
std::string job_schema_text(const nlohmann::ordered_json& more = nlohmann::ordered_json::object());

}  // namespace rodsweep
