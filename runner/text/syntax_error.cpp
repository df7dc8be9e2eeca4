#include "runner/text/syntax_error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "runner/text/words.hpp"

namespace rodsweep {
namespace {

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

}  // namespace

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

}  // namespace rodsweep
