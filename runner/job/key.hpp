// One key of a job file, described once. Reading, defaults, refusals, the columns of the results file and help texts
// all follow from these rows; job_keys.cpp begins the whole, key_table.hpp binds many of them to what they fill.
#pragma once

#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace rodsweep {

struct Key {
  enum class Kind {
    object,   ///< `keys` are its members; or one of `choices`, a word that stands for none of them
    integer,  ///< within [low, high]
    boolean,  ///< true or false
    number,   ///< finite, within the bounds; or one of `choices`, a word that stands for a number
    vector,   ///< three numbers, each within the bounds
    text,     ///< 1 to `high` bytes of the form `text`
    choice,   ///< one of `choices`
    variant,  ///< an object with exactly one of `keys`, which says what kind of thing it is, and its members within
    list,     ///< of values of the one key in `keys`, none or more
    guess,    ///< a name of guess_keys(), or an object with that name as its one key and the guess's parameters within
    guesses   ///< a list of guesses, each with a label of its own
  };

  enum class Text {
    any,       ///< may be empty
    line,      ///< no control characters
    path,      ///< of a file that must be there, relative to the job file
    file_name  ///< letters, digits, "_", "-" and ".", beginning with none of the latter two
  };

  /// Where the magnitudes of real things lie, or 0. A value outside is warned of, not refused.
  struct Plausible {
    double least, most;
    std::string known;  ///< to compare with: "water has 1000", or ""
  };

  std::string name;
  Kind kind = Kind::object;
  std::string unit;  ///< SI, "" where there is none
  std::string help;  ///< one line

  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool above_low = false;  ///< `low` itself is excluded
  std::optional<Plausible> plausible;
  std::vector<std::string> choices;
  Text text = Text::any;
  std::optional<nlohmann::ordered_json> preset;              ///< value if the key is absent; none: the key is required
  std::map<std::string, nlohmann::ordered_json> preset_for;  ///< another one, for these values of the enclosing `tag`
  bool labelled = true;                                      ///< of a guess: part of its label?
  bool labelled_as_preset = true;                            ///< also where it has its preset value?
  std::string label_word;                                    ///< what a label says before its value
  bool sweepable = true;                                     ///< may its value be a sweep?
  bool parameter = true;              ///< part of a task's parameters, not a setting of the whole job?
  bool or_list = false;               ///< or a list of at least one such value
  std::string no_sweep_advice;        ///< what to do instead of sweeping it
  std::string alias;                  ///< another name that is accepted as the same, or ""
  std::vector<std::string> synonyms;  ///< other words for it: suggested, never accepted
  std::vector<std::string> only_for;  ///< the values of the enclosing `tag`, of its own object or one further out, that
                                      ///< have this key; none: all have
  std::string only_advice;            ///< what to do where the tag has another value
  std::string alternative_group;      ///< exactly one of the keys with the same group must be given

  std::string tag;        ///< object: the member whose value decides which `only_for` members apply
  std::vector<Key> keys;  ///< object: its members; variant: the kinds; list: what each item is

  Key& in(const char* si_unit);
  Key& above(double bound);
  Key& at_least(double bound);
  Key& at_most(double bound);
  Key& from(double least, double most);
  Key& plausibly(double least, double most, const char* known = "");
  Key& or_word(const char* word);
  Key& defaults_to(nlohmann::ordered_json value);
  Key& only(std::vector<std::string> tag_values, const char* advice = "");
  Key& otherwise(const char* advice);  ///< only_advice, where a table of keys knows whose the key is
  Key& one_of_group(const char* group);
  Key& of_form(Text form);
  Key& also_accepted_as(const char* name);
  Key& also_called(std::vector<std::string> words);
  Key& unswept(const char* advice = "");
  Key& or_list_of_such();
  Key& unlabelled();
  Key& labelled_if_changed(const char* word = "");  ///< "word value"
  Key& setting();  ///< concerns the whole job: neither swept nor a parameter of its tasks
};

Key object_key(const char* name, const char* help, std::vector<Key> keys = {}, const char* tag = "");
Key integer_key(const char* name, const char* help);
Key boolean_key(const char* name, const char* help);
Key number_key(const char* name, const char* help);
Key vector_key(const char* name, const char* help);
Key text_key(const char* name, const char* help);
Key file_key(const char* name, const char* help);  ///< a file that the job reads
Key choice_key(const char* name, const char* help, std::vector<std::string> choices = {});
Key variant_key(const char* name, const char* help, std::vector<Key> kinds);
Key list_key(const char* name, const char* help, Key item);
Key guess_key(const char* name, const char* help);
Key guesses_key(const char* name, const char* help);

/// The key of one value of a list, where `or_list` allows one.
Key item_key(const Key& listed);

/// The key of one component of a vector.
Key component_key(const Key& vector);

/// What a key takes, to follow "must be": "an integer from 1 to 1000000", "one of "none", "jacobi"".
std::string allowed(const Key& key);

/// "clamped length [m], a number above 0".
std::string describe(const Key& key);

/// Member by name or alias, nullptr if there is none.
const Key* find_key(const std::vector<Key>& keys, const std::string& name);

/// Does a key belong to this value of the tag?
bool belongs(const Key& key, const std::string& tag_value);

/// Its value where it is absent.
std::optional<nlohmann::ordered_json> preset_of(const Key& key, const std::string& tag_value);

/// As a job has it: 1 rather than 1.0.
nlohmann::ordered_json number(double value);

/// "a", "b", "c"
std::string quoted_list(const std::vector<std::string>& words);

}  // namespace rodsweep
