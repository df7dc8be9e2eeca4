// Checks a job's JSON against the table of keys (runner/keys/key.hpp) and fills in the defaults. All values of a
// sweep are checked, and both ends of a range. Collects all mistakes, not only the first.
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "runner/keys/key.hpp"
#include "runner/text/job_error.hpp"

namespace rodsweep {

class JobReader {
 public:
  using Json = nlohmann::ordered_json;

  explicit JobReader(std::filesystem::path file) : file_(std::move(file)) {}

  /// The normalised value: with defaults, and all guesses in the form {"name": {parameters, "label"}} or
  /// {"grid": [...], "label"}.
  Json read(const Key& key, const Json& value, const std::string& path);

  /// The job's input files by path as written.
  const std::map<std::string, FileUses>& files() const { return files_; }

  /// One line for each value that is allowed but not plausible.
  const std::vector<std::string>& warnings() const { return warnings_; }

  /// Throws JobError with one line for each of the first mistakes, if any.
  void throw_mistakes() const;

 private:
  Json read_sweep(const Key& key, const Json& value, const std::string& path);
  Json read_range(const Key& key, const std::string& word, const Json& ends, const std::string& path);
  Json read_object(const Key& key, const Json& value, const std::string& path);
  Json read_variant(const Key& key, const Json& value, const std::string& path);
  Json read_items(const Key& item, const Json& values, const std::string& path);
  Json read_list(const Key& key, const Json& value, const std::string& path);
  Json read_number(const Key& key, const Json& value, const std::string& path);
  void use(const std::string& file, FileKind kind, const std::string& path);
  Json read_text(const Key& key, const Json& value, const std::string& path);
  Json read_guess(const Key& key, const Json& value, const std::string& path, bool labelled);
  Json read_varying_guess(const Key& key, Json sweep, std::size_t index, const std::string& path);
  Json read_guesses(const Json& value, const std::string& path);
  void refuse_unknown(const Key& key, const std::string& name, const std::string& path);
  void fill_absent(const Key& key, const std::string& path, Json& result);
  bool applies(const Key& key) const;
  void warn_if_implausible(const Key& key, double value, const std::string& path);
  /// Returns the value.
  const Json& refuse(const Key& key, const Json& value, const std::string& path, const std::string& remark = "");
  /// `text`: maybe a format and its values.
  template <class... Text>
  void mistake(const std::string& path, const Text&... text) {
    if (mistakes_++ < most_told) told_.emplace_back(job_error(file_, path, text...).what());
  }

  /// The tag determines which keys apply. An object without a tag has that of its parent.
  struct Tag {
    std::string path, value;  ///< empty if missing or wrong: then all keys are accepted
  };
  static Tag tag_of(const Key& key, const Json& value, const std::string& path);

  static constexpr std::size_t most_told = 20;
  std::filesystem::path file_;
  Tag tag_;
  std::size_t mistakes_ = 0;
  std::vector<std::string> told_;  ///< texts of the first mistakes
  std::map<std::string, FileUses> files_;
  std::vector<std::string> warnings_;
};

}  // namespace rodsweep
