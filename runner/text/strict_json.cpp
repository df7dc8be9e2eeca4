#include "runner/text/strict_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <vector>

#include "runner/text/job_error.hpp"
#include "runner/text/words.hpp"

namespace rodsweep {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t deepest = 64;      // limits all recursions over a job
constexpr std::size_t most_keys = 1000;  // per object; their search is linear

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }
bool continues_character(char c) { return (static_cast<unsigned char>(c) & 0xC0) == 0x80; }

/// The line around position `at`, shortened for a terminal, with a caret under `at`.
std::string shown_line(const std::string& text, std::size_t begin, std::size_t at) {
  constexpr std::size_t before = 60, after = 40;  // bytes shown of a long line
  std::size_t first = at - begin > before ? at - before : begin;
  while (first > begin && continues_character(text[first])) --first;
  std::size_t end = std::min({text.find_first_of("\r\n", at), text.size(), at + after});
  while (end < text.size() && continues_character(text[end])) ++end;
  std::string line(text, first, end - first), blanks(text, first, at - first);
  for (std::string* shown : {&line, &blanks})
    std::replace_if(
        shown->begin(), shown->end(), [](unsigned char c) { return c != '\t' && (c < 0x20 || c == 0x7f); }, ' ');
  blanks.erase(std::remove_if(blanks.begin(), blanks.end(), continues_character), blanks.end());
  std::replace_if(
      blanks.begin(), blanks.end(), [](char c) { return c != '\t'; }, ' ');
  return text.find_first_not_of(" \t\r\n") == std::string::npos ? "" : fmt::format("\n{}\n{}^", line, blanks);
}

/// "line 3, column 9: PROBLEM" and the line itself. Lines and columns (characters) count from 1.
std::string placed(const std::string& text, std::size_t at, const std::string& problem) {
  const std::size_t newline = at == 0 ? std::string::npos : text.rfind('\n', at - 1);
  const std::size_t begin = newline == std::string::npos ? 0 : newline + 1;
  const auto of = [&](std::size_t place) { return text.begin() + static_cast<std::ptrdiff_t>(place); };
  return fmt::format("line {}, column {}: {}{}", 1 + std::count(text.begin(), of(at), '\n'),
                     1 + std::count_if(of(begin), of(at), [](char c) { return !continues_character(c); }), problem,
                     shown_line(text, begin, at));
}

/// The begin of the token whose last character is at `end`; `token`: as stored by the parser.
std::size_t token_begin(const std::string& text, std::size_t end, const std::string& token) {
  if (text[end] == '"' && token.size() <= end + 1 && text.compare(end + 1 - token.size(), token.size(), token) == 0)
    return end + 1 - token.size();
  const auto is_word = [](unsigned char c) { return std::isalnum(c) != 0 || c == '.' || c == '-' || c == '+'; };
  while (is_word(static_cast<unsigned char>(text[end])) && end > 0 &&
         is_word(static_cast<unsigned char>(text[end - 1])))
    --end;
  return end;
}

/// Whether a value or key follows where the end of an object or list is expected.
bool lacks_comma(const std::string& problem) {
  const bool at_end =
      problem.find("expected '}'") != std::string::npos || problem.find("expected ']'") != std::string::npos;
  const auto unexpected = [&](const char* token) {
    return problem.find(std::string("unexpected ") + token) != std::string::npos;
  };
  return at_end &&
         (unexpected("string literal") || unexpected("number literal") || unexpected("true literal") ||
          unexpected("false literal") || unexpected("null literal") || unexpected("'{'") || unexpected("'['"));
}

bool expects(const std::string& problem, const char* token) {
  return problem.find(fmt::format("; expected '{}'", token)) != std::string::npos;
}

/// The text for a list or object that is not closed; empty for other problems.
std::string unclosed_text(const std::string& problem) {
  if (expects(problem, "]")) return "the list before this is not closed: ] is missing";
  if (expects(problem, "}")) return "the object before this is not closed: } is missing";
  return "";
}

/// An explanation of the wrong token at `at`; else the parser's message.
std::string wrong_token_text(const std::string& text, std::size_t at, const std::string& problem) {
  const char c = text[at];
  if (c == '/' || c == '#') return "JSON does not allow comments: remove it, or put it into \"description\"";
  if (c == '\'') return "strings and keys must be in double quotes";
  std::size_t end = at;
  while (end < text.size() && std::isalpha(static_cast<unsigned char>(text[end])) != 0) ++end;
  const std::string word = lower_case(text.substr(at, std::min<std::size_t>(end - at, 20)));
  if (word.empty() || problem.find("invalid literal") == std::string::npos) return problem;
  if (word == "true" || word == "false") return fmt::format("{} must be in lower case", word);
  if (word == "none") return "use null instead of none";
  if (word == "nan" || word == "inf" || word == "infinity") return "JSON does not allow NaN or infinity";
  return "strings and keys must be in double quotes";
}

/// Explains a JSON syntax error and shows its line with a caret. nlohmann's parser reports the unexpected token, but the
/// mistake is usually one token earlier: a missing or superfluous comma.
///
/// "line 2, column 9: a comma is missing here", and that line with a caret. `last`: the position of the last character
/// of the unexpected token (the text's size at its end); `token`: the token as stored by the parser; `problem`: the
/// parser's message.
std::string syntax_error_text(const std::string& text, std::size_t last, const std::string& token,
                              const std::string& problem) {
  const auto after_last_entry = [&](std::size_t place) {
    while (place > 0 && is_space(text[place - 1])) --place;
    return place;
  };
  if (problem.find("unexpected end of input") != std::string::npos) {
    const std::string unclosed = unclosed_text(problem);
    return placed(text, after_last_entry(text.size()), unclosed.empty() ? problem : unclosed);
  }
  if (last < text.size() && lacks_comma(problem))
    return placed(text, after_last_entry(token_begin(text, last, token)), "a comma is missing here");
  const std::size_t before = after_last_entry(last);
  if (last < text.size() && (text[last] == '}' || text[last] == ']') && before > 0 && text[before - 1] == ',')
    return placed(text, before - 1, "JSON does not allow a comma after the last entry: remove it");
  if (last >= text.size()) return placed(text, last, problem);
  const bool other_bracket =
      (text[last] == '}' && expects(problem, "]")) || (text[last] == ']' && expects(problem, "}"));
  if (other_bracket) return placed(text, last, unclosed_text(problem));
  const std::size_t begin = token_begin(text, last, token);
  return placed(text, begin, wrong_token_text(text, begin, problem));
}

class StrictReader : public nlohmann::json_sax<Json> {
 public:
  StrictReader(const std::string& text, const std::filesystem::path& file) : text_(text), file_(file) {}

  Json take() { return std::move(root_); }

  bool null() override { return add(nullptr); }
  bool boolean(bool value) override { return add(value); }
  bool number_integer(number_integer_t value) override { return add(value); }
  bool number_unsigned(number_unsigned_t value) override { return add(value); }
  bool number_float(number_float_t value, const string_t&) override { return add(value); }
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
      throw job_error(file_, path(), "this object has more than {} keys", most_keys);
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
      throw job_error(file_, path(), "nested deeper than {} levels", deepest);
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
