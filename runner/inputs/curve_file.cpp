#include "runner/inputs/curve_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <utility>

#include "runner/inputs/parsed_file.hpp"
#include "runner/text/job_error.hpp"
#include "runner/text/strict_json.hpp"
#include "runner/text/words.hpp"

namespace rodsweep {
namespace {

using Json = nlohmann::ordered_json;

/// The fields of each line, without comments and quotes.
class Lines {
 public:
  Lines(const std::string& text, const std::filesystem::path& file) : file_(file), in_(with_line_feeds(text)) {}

  bool next() {
    std::string line;
    if (!std::getline(in_, line)) return false;
    ++number_;
    is_comment_ = line.find('#') != std::string::npos;
    line.erase(std::min(line.find('#'), line.size()));
    line.erase(std::remove(line.begin(), line.end(), '"'), line.end());
    words.clear();
    for (std::size_t begin = 0; begin <= line.size();) {
      const std::size_t end = std::min(line.find_first_of(",;", begin), line.size());
      std::istringstream parts(line.substr(begin, end - begin));
      const std::size_t before = words.size();
      for (std::string word; parts >> word;) words.push_back(word);
      if (words.size() == before) words.emplace_back();  // an empty field
      begin = end + 1;
    }
    const auto is_empty = [](const std::string& word) { return word.empty(); };
    if (std::all_of(words.begin(), words.end(), is_empty)) words.clear();
    return true;
  }

  std::vector<std::string> words;
  bool is_blank() const { return words.empty() && !is_comment_; }

  template <class Number>
  Number number(std::size_t word, const char* name, const char* bound) const {
    const auto value = number_in<Number>(words[word]);
    if (!value || !std::isfinite(static_cast<double>(*value)))
      refuse(fmt::format("{} is \"{}\"; must be {}", name, shortened(words[word]), bound));
    return *value;
  }
  /// x, y and z are these words.
  Vector3 point(std::size_t x, std::size_t y, std::size_t z) const {
    constexpr const char* bound = "a finite number";
    return {number<double>(x, "x", bound), number<double>(y, "y", bound), number<double>(z, "z", bound)};
  }
  [[noreturn]] void refuse(const std::string& text) const {
    throw CurveError("{}:{}: {}", file_.native(), number_, text);
  }

 private:
  const std::filesystem::path& file_;
  std::istringstream in_;
  int number_ = 0;
  bool is_comment_ = false;
};

/// The columns of a table: x, y, z and maybe a radius, where a header says, or in this order.
class Columns {
 public:
  /// Whether the line is a header, which it then reads: names of columns, the first of which may be an index without one.
  bool read_header(const Lines& lines) {
    const auto first =
        std::find_if(lines.words.begin(), lines.words.end(), [](const auto& word) { return word != ""; });
    if (number_in<double>(*first)) return false;
    std::array<bool, names.size()> found{};
    for (std::size_t i = 0; i < lines.words.size(); ++i) {
      const std::string word = lower_case(lines.words[i]);
      const auto k = static_cast<std::size_t>(std::find(names.begin(), names.end(), word) - names.begin());
      if (i == 0 && word.empty()) continue;
      if (k == names.size() || std::exchange(found[k], true))
        lines.refuse(fmt::format("column {} is \"{}\"; must be one of x, y, z and radius, each once", i + 1,
                                 shortened(lines.words[i])));
      place_[k] = i;
    }
    for (std::size_t k = 0; k < 3; ++k)
      if (!found[k])
        lines.refuse(fmt::format("no column is called \"{}\"; must be x, y, z or x, y, z, radius", names[k]));
    has_header_ = true;
    has_radius_ = found[3];
    count_ = lines.words.size();
    return true;
  }

  void add(const Lines& lines, Curve& curve) {
    const std::size_t count = lines.words.size();
    if (!has_header_ && count != 3 && count != 4)
      lines.refuse(fmt::format("{} values; must be x y z, or x y z radius", count));
    if (!has_header_ && curve.points.empty()) {
      count_ = count;
      has_radius_ = count == 4;
    }
    if (count != count_)
      lines.refuse(fmt::format("{} values; must be {}, as in the {}", count, count_,
                               has_header_ ? "header" : "curve's first line"));
    curve.points.push_back(lines.point(place_[0], place_[1], place_[2]));
    if (has_radius_) curve.radii.push_back(lines.number<double>(place_[3], "radius", "a finite number"));
  }

 private:
  static constexpr std::array<const char*, 4> names{"x", "y", "z", "radius"};
  std::array<std::size_t, 4> place_{0, 1, 2, 3};
  std::size_t count_ = 0;
  bool has_header_ = false, has_radius_ = false;
};

std::vector<Curve> from_table(Lines lines) {
  std::vector<Curve> curves;
  Columns columns;
  bool begins = true, first = true;
  while (lines.next()) {
    if (lines.is_blank()) begins = true;
    if (lines.words.empty() || (std::exchange(first, false) && columns.read_header(lines))) continue;
    if (std::exchange(begins, false)) curves.emplace_back();
    columns.add(lines, curves.back());
  }
  return curves;
}

std::vector<Curve> from_obj(Lines lines) {
  std::vector<Vector3> points;
  std::vector<Curve> curves;
  while (lines.next()) {
    if (lines.words.empty()) continue;
    if (lines.words[0] == "v") {
      if (lines.words.size() < 4) lines.refuse("\"v\" needs x y z");
      points.push_back(lines.point(1, 2, 3));
    }
    if (lines.words[0] != "l") continue;
    Curve& curve = curves.emplace_back();
    for (std::size_t i = 1; i < lines.words.size(); ++i) {
      lines.words[i].erase(std::min(lines.words[i].find('/'), lines.words[i].size()));  // a texture's point
      const int given = lines.number<int>(i, "a point of \"l\"", "the number of a \"v\" above");
      const int index = given > 0 ? given - 1 : static_cast<int>(points.size()) + given;
      if (given == 0 || index < 0 || index >= static_cast<int>(points.size()))
        lines.refuse(fmt::format("a point of \"l\" is {}; must be the number of one of the {} \"v\" above", given,
                                 points.size()));
      curve.points.push_back(points[static_cast<std::size_t>(index)]);
    }
  }
  return curves;
}

class JsonCurves {
 public:
  JsonCurves(const std::string& text, const std::filesystem::path& file)
      : file_(file), json_(parse_strict_json(text, file)) {}

  std::vector<Curve> read() const {
    if (!json_.is_object() || !json_.contains("curves") || !json_["curves"].is_array())
      refuse("curves", "missing; must be a list of curves");
    std::vector<Curve> curves;
    for (std::size_t i = 0; i < json_["curves"].size(); ++i)
      curves.push_back(curve(json_["curves"][i], element("curves", i)));
    return curves;
  }

 private:
  Curve curve(const Json& json, const std::string& path) const {
    if (!json.is_object() || !json.contains("points") || !json["points"].is_array())
      refuse(member(path, "points"), "missing; must be a list of [x, y, z]");
    Curve out;
    for (const auto& [key, value] : json.items()) {
      const std::string at = member(path, key);
      if (key == "points") {
        for (std::size_t i = 0; i < value.size(); ++i) out.points.push_back(point(value[i], element(at, i)));
      } else if (key == "radius") {
        out.radii = radii(value, json["points"].size(), at);
      } else if (key == "name" && value.is_string()) {
        out.name = "curve \"" + value.get<std::string>() + '"';
      } else if (key == "youngs_modulus_pa") {
        out.youngs_modulus_pa = positive(value, at);
      } else if (key == "torsion_modulus_pa") {
        out.torsion_modulus_pa = positive(value, at);
      } else if (key == "density_kg_m3") {
        out.density_kg_m3 = positive(value, at);
      } else {
        refuse(at,
               "not allowed; a curve has points, radius, name, youngs_modulus_pa, torsion_modulus_pa, density_kg_m3");
      }
    }
    return out;
  }

  std::vector<double> radii(const Json& value, std::size_t points, const std::string& path) const {
    if (!value.is_array()) return std::vector<double>(points, positive(value, path));
    if (value.size() != points)
      refuse(path, fmt::format("{} values; must be one, or {} as points", value.size(), points));
    std::vector<double> out;
    for (std::size_t i = 0; i < points; ++i) out.push_back(positive(value[i], element(path, i)));
    return out;
  }
  Vector3 point(const Json& value, const std::string& path) const {
    if (!value.is_array() || value.size() != 3)
      refuse(path, shortened(value.dump()) + " is not allowed; must be [x, y, z]");
    Vector3 out;
    for (std::size_t i = 0; i < 3; ++i) out[static_cast<int>(i)] = number(value[i], element(path, i));
    return out;
  }
  double number(const Json& value, const std::string& path) const {
    if (!value.is_number()) refuse(path, shortened(value.dump()) + " is not allowed; must be a number");
    return value;
  }
  double positive(const Json& value, const std::string& path) const {
    const double found = number(value, path);
    if (!(found > 0)) refuse(path, fmt::format("{} is not allowed; must be positive", found));
    return found;
  }
  [[noreturn]] void refuse(const std::string& path, const std::string& text) const {
    throw CurveError("{}: {}: {}", file_.native(), path, text);
  }

  const std::filesystem::path& file_;
  Json json_;
};

}  // namespace

std::vector<Curve> parse_curves(const std::string& text, const std::filesystem::path& file) {
  const std::string ending = lower_case(file.extension().native());
  std::vector<Curve> curves;
  if (ending == ".json")
    curves = JsonCurves(text, file).read();
  else if (ending == ".obj")
    curves = from_obj({text, file});
  else if (ending == ".csv" || ending == ".txt")
    curves = from_table({text, file});
  else
    throw CurveError(file.native() + ": the name ends in \"" + ending + "\"; must be .csv, .txt, .json or .obj" +
                     (ending == ".swc" ? "; the scene \"skeleton\" reads .swc" : ""));
  if (curves.empty()) throw CurveError(file.native() + ": has no curve");
  for (std::size_t i = 0; i < curves.size(); ++i)
    if (curves[i].name.empty()) curves[i].name = fmt::format("curve {}", i + 1);
  return curves;
}

const std::vector<Curve>& shared_curves(const std::filesystem::path& file, const std::string& hash) {
  return parsed_once<CurveError>(file, hash, parse_curves);
}

}  // namespace rodsweep
