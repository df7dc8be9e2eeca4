#include "runner/text/strict_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "runner/text/job_error.hpp"
#include "runner/text/shortened.hpp"
#include "runner/text/syntax_error.hpp"

namespace rodsweep {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t deepest = 64;      // limits all recursions over a job
constexpr std::size_t most_keys = 1000;  // per object; their search is linear

class StrictReader : public nlohmann::json_sax<Json> {
 public:
  StrictReader(const std::string& text, const std::filesystem::path& file) : text_(text), file_(file) {}

  Json take() { return std::move(root_); }

  bool null() override { return add(nullptr); }
  bool boolean(bool value) override { return add(value); }
  bool number_integer(number_integer_t value) override { return add(value); }
  bool number_unsigned(number_unsigned_t value) override { return add(value); }
  bool number_float(number_float_t value, const string_t& written) override {
    if (!std::isfinite(value)) throw job_error(file_, path(), shortened(written) + " is too large for a number");
    return add(value);
  }
  bool string(string_t& value) override { return add(std::move(value)); }
  bool binary(binary_t&) override { return false; }  // occurs only in binary formats

  bool start_object(std::size_t) override { return open(Json::object()); }
  bool start_array(std::size_t) override { return open(Json::array()); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }

  bool key(string_t& name) override {
    Level& level = levels_.back();
    level.key = name;
    if (level.container->contains(name)) {
      throw job_error(file_, path(), "this key is given more than once; remove all but one");
    }
    if (level.container->size() == most_keys)
      throw job_error(file_, path(), fmt::format("this object has more than {} keys", most_keys));
    return true;
  }

  bool parse_error(std::size_t position, const std::string& last_token, const nlohmann::detail::exception& e) override {
    constexpr int overflow = 406;
    if (e.id == overflow) throw job_error(file_, path(), shortened(last_token) + " is too large for a number");
    std::string problem = e.what();
    const std::size_t column_mark = problem.find(", column ");
    const std::size_t end_of_prefix = column_mark == std::string::npos ? column_mark : problem.find(": ", column_mark);
    if (end_of_prefix != std::string::npos) problem.erase(0, end_of_prefix + 2);
    if (const std::size_t token = problem.find(last_token); token != std::string::npos)
      problem.replace(token, last_token.size(), shortened(last_token));
    const std::size_t last = std::min(position == 0 ? 0 : position - 1, text_.size());
    throw JobError(file_.string() + ": " + syntax_error_text(text_, last, last_token, problem));
  }

 private:
  struct Level {
    Json* container;
    std::string key;
  };

  std::string path() const {
    std::string result;
    for (const Level& level : levels_) {
      if (level.container->is_array()) {
        // An open element is already in its array; the innermost array gets its next element now.
        const std::size_t open = &level == &levels_.back() ? 0 : 1;
        result += fmt::format("[{}]", level.container->size() - open);
      } else {
        result += (result.empty() ? "" : ".") + level.key;
      }
    }
    return result;
  }

  Json* place(Json value) {
    if (levels_.empty()) {
      root_ = std::move(value);
      return &root_;
    }
    const Level& level = levels_.back();
    if (level.container->is_array()) {
      level.container->push_back(std::move(value));
      return &level.container->back();
    }
    return &((*level.container)[level.key] = std::move(value));
  }

  bool add(Json value) {
    place(std::move(value));
    return true;
  }

  bool open(Json empty) {
    if (levels_.size() == deepest) {
      throw job_error(file_, path(), fmt::format("nested deeper than {} levels", deepest));
    }
    Json* container = place(std::move(empty));
    levels_.push_back({container, {}});
    return true;
  }

  bool close() {
    levels_.pop_back();
    return true;
  }

  const std::string& text_;
  const std::filesystem::path& file_;
  Json root_;
  std::vector<Level> levels_;
};

}  // namespace

Json parse_strict_json(const std::string& text, const std::filesystem::path& file) {
  // The parser would stop at a zero byte and ignore the rest of the text.
  if (text.find('\0') != std::string::npos)
    throw job_error(file, "", "holds a zero byte, so it is not JSON in UTF-8; save it as UTF-8");
  StrictReader reader(text, file);
  Json::sax_parse(text, &reader);
  return reader.take();
}

}  // namespace rodsweep
