#include "runner/keys/job_reader.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "runner/keys/sweep_words.hpp"
#include "runner/text/words.hpp"

namespace rodsweep {
namespace {

using Json = nlohmann::ordered_json;

/// A value as JSON, shortened.
std::string written(const Json& value) { return shortened(value.dump()); }

/// Whether the value has the JSON type of the key's values.
bool looks_like_one(const Key& key, const Json& value) {
  switch (key.kind) {
    case Key::Kind::integer:
    case Key::Kind::number: return value.is_number() || (value.is_string() && !key.choices.empty());
    case Key::Kind::boolean: return value.is_boolean();
    case Key::Kind::text:
    case Key::Kind::choice: return value.is_string();
    case Key::Kind::vector: return value.is_array() && value.size() == 3 && value[0].is_number();
    default: return value.is_object();
  }
}

/// Advice to write a sweep, if a plain list of values is given where one value is expected.
std::string sweep_advice(const Key& key, const Json& value) {
  const auto is_one = [&](const Json& item) { return looks_like_one(key, item); };
  if (!key.sweepable || !value.is_array() || value.empty() || !std::all_of(value.begin(), value.end(), is_one))
    return "";
  std::string items;
  for (const Json& item : value) items += (items.empty() ? "" : ", ") + item.dump();
  if (items.size() > 40) items = value[0].dump() + ", ...";
  std::string advice = fmt::format("; to sweep over these values write {{\"grid\": [{}]}}", items);
  const bool of_numbers = key.kind == Key::Kind::integer || key.kind == Key::Kind::number;
  if (of_numbers && value.size() == 2 && value[0].is_number() && value[0] < value[1])
    advice += fmt::format(", to draw from the range {{\"{}\": [{}]}}",
                          key.kind == Key::Kind::integer ? "integer" : "uniform", items);
  return advice;
}

bool has_form(const std::string& text, Key::Text form) {
  if (form == Key::Text::any) return true;
  if (text.empty()) return false;
  if (form == Key::Text::line || form == Key::Text::path) {
    return std::none_of(text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; });
  }
  const std::string allowed = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-.";
  return text.find_first_not_of(allowed) == std::string::npos && text[0] != '-' && text[0] != '.';
}

}  // namespace

const Json& JobReader::refuse(const Key& key, const Json& value, const std::string& path, const std::string& remark) {
  mistake(path, "{} is not allowed; must be {}{}{}", written(value), allowed(key), remark, sweep_advice(key, value));
  return value;
}

void JobReader::warn_if_implausible(const Key& key, double value, const std::string& path) {
  if (!key.plausible || is_plausible(key, value)) return;
  const auto& [least, most, known] = *key.plausible;
  warnings_.emplace_back(job_error(file_, path, "{:g} {} is outside the plausible range, {:g} to {:g} {}{}{}", value,
                                   key.unit, least, most, key.unit, known.empty() ? "" : fmt::format(" ({})", known),
                                   other_unit(key, value, most))
                             .what());
}

void JobReader::throw_mistakes() const {
  if (mistakes_ == 0) return;
  std::string text = fmt::format("{}", fmt::join(told_, "\n"));
  if (mistakes_ > told_.size()) text += fmt::format("\n{}: and {} more", file_.string(), mistakes_ - told_.size());
  throw JobError(text);
}

Json JobReader::read(const Key& key, const Json& value, const std::string& path) {
  if (!sweep_word(value).empty()) return read_sweep(key, value, path);
  if (key.or_list && value.is_array() && !value.empty()) return read_items(item_key(key), value, path);
  switch (key.kind) {
    case Key::Kind::object: return value.is_string() ? read_text(key, value, path) : read_object(key, value, path);
    case Key::Kind::integer:
    case Key::Kind::number: return read_number(key, value, path);
    case Key::Kind::boolean:
      if (!value.is_boolean()) refuse(key, value, path);
      return value;
    case Key::Kind::text:
    case Key::Kind::choice: return read_text(key, value, path);
    case Key::Kind::variant: return read_variant(key, value, path);
    case Key::Kind::list: return read_list(key, value, path);
    case Key::Kind::guess: return read_guess(key, value, path, false);
    case Key::Kind::guesses: return read_guesses(value, path);
    case Key::Kind::vector: {
      if (!value.is_array() || value.size() != 3) return refuse(key, value, path);
      Json result = Json::array();
      for (std::size_t i = 0; i < 3; ++i) result.push_back(read(component_key(key), value[i], element(path, i)));
      return result;
    }
  }
  throw std::logic_error("a kind of key that is not read");
}

Json JobReader::read_sweep(const Key& key, const Json& value, const std::string& path) {
  const std::string word = sweep_word(value);
  const Json& content = value[word];
  if (!key.sweepable) {
    mistake(path.empty() ? word : path,
            "this key cannot be swept" + (key.no_sweep_advice.empty() ? "" : "; " + key.no_sweep_advice));
    return value;
  }
  if (value.size() != 1) {
    mistake(path, "{} is not allowed; a sweep must have no key other than \"{}\"", written(value), word);
    return value;
  }
  if (!is_listed(word)) return Json{{word, read_range(key, word, content, member(path, word))}};
  if (!content.is_array() || content.empty()) {
    mistake(member(path, word), "{} is not allowed; must be a list of at least one value", written(content));
    return value;
  }
  Json values = Json::array();
  for (std::size_t i = 0; i < content.size(); ++i) {
    values.push_back(read(key, content[i], element(member(path, word), i)));
  }
  return Json{{word, std::move(values)}};
}

Json JobReader::read_range(const Key& key, const std::string& word, const Json& ends, const std::string& path) {
  const bool whole = word == "integer";
  if (key.kind == Key::Kind::integer && !whole) {
    mistake(path, "{} draws fractional numbers; use {{\"integer\": [a, b]}} here", word);
    return ends;
  }
  if (key.kind != Key::Kind::integer && key.kind != Key::Kind::number) {
    mistake(path, "{} draws a number, which is not allowed here; must be {}", word, allowed(key));
    return ends;
  }
  if (!ends.is_array() || ends.size() != 2) {
    mistake(path, "{} is not allowed; must be the two ends of a range [a, b]", written(ends));
    return ends;
  }
  Key end_key = key;
  if (whole) end_key.kind = Key::Kind::integer;
  end_key.choices.clear();  // the ends of a range are numbers
  end_key.sweepable = false;
  const std::size_t before = mistakes_;
  Json result = Json::array();
  for (std::size_t i = 0; i < 2; ++i) {
    if (sweep_word(ends[i]).empty()) {
      result.push_back(read_number(end_key, ends[i], element(path, i)));
    } else {
      refuse(end_key, ends[i], element(path, i), "; the ends of a range cannot be swept");
    }
  }
  if (mistakes_ != before) return ends;
  const double low = result[0].get<double>(), high = result[1].get<double>();
  if (low > high) {
    mistake(path, "{} is not allowed; the first end must not be above the second", written(ends));
  } else if (word == "log_uniform" && low <= 0) {
    mistake(path, "{} is not allowed; a log_uniform range must lie above 0", written(ends));
  }
  return result;
}

Json JobReader::read_number(const Key& key, const Json& value, const std::string& path) {
  if (value.is_string()) {
    for (const std::string& word : key.choices) {
      if (value == word) return value;
    }
    return refuse(key, value, path, key.choices.size() > 1 ? did_you_mean(value.get<std::string>(), key.choices) : "");
  }
  if (value.is_object() && value.size() == 1)
    return refuse(key, value, path, did_you_mean(value.begin().key(), sweep_words()));
  if (!value.is_number() || !fits(key, value.get<double>())) return refuse(key, value, path);
  warn_if_implausible(key, value.get<double>(), path);
  return key.kind == Key::Kind::integer ? Json(static_cast<std::int64_t>(value.get<double>())) : value;
}

void JobReader::use(const std::string& file, FileKind kind, const std::string& path) {
  FileUses& uses = files_[file];
  if (std::none_of(uses.begin(), uses.end(), [&](const FileUse& use) { return use.kind == kind; }))
    uses.push_back({path, kind});
}

Json JobReader::read_text(const Key& key, const Json& value, const std::string& path) {
  if (!value.is_string()) return refuse(key, value, path);
  const auto& text = value.get_ref<const std::string&>();
  if (key.kind == Key::Kind::text) {
    if (static_cast<double>(text.size()) > key.high || !has_form(text, key.text))
      refuse(key, value, path);
    else if (key.text == Key::Text::path)
      use(text, key.file, path);
    return value;
  }
  for (const std::string& choice : key.choices) {
    if (text == choice) return value;
  }
  return refuse(key, value, path, key.choices.size() > 1 ? did_you_mean(text, key.choices) : "");
}

}  // namespace rodsweep
