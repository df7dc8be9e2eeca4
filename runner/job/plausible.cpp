#include "runner/job/plausible.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "runner/job/key_path.hpp"
#include "runner/job/sweep.hpp"

namespace rodsweep {
namespace {

using Json = nlohmann::ordered_json;

/// Another unit in which a value may have been meant, in units of the key.
struct Unit {
  const char* name;
  double size;
};

struct Plausible {
  const char* key;
  const char* unit;
  double least, most;  ///< of the magnitude; 0 is always plausible
  const char* known;   ///< what the reader can compare with; or ""
  std::vector<Unit> others;
};

const std::vector<Plausible>& table() {
  const std::vector<Unit> lengths{{"mm", 1e-3}, {"um", 1e-6}}, pressures{{"GPa", 1e9}, {"MPa", 1e6}, {"kPa", 1e3}};
  static const std::vector<Plausible> rows{
      {"length_m", "m", 1e-4, 1e3, "", lengths},
      {"radius_m", "m", 1e-6, 10, "", lengths},
      {"helix_radius_m", "m", 1e-5, 1e2, "", lengths},
      {"helix_height_m", "m", 1e-5, 1e3, "", lengths},
      {"mesh_m", "m", 1e-5, 1e2, "", lengths},
      {"density_kg_m3", "kg/m^3", 10, 25000, "water has 1000, steel 7850", {{"g/cm^3", 1e3}, {"g/m^3", 1e-3}}},
      {"youngs_modulus_pa", "Pa", 1e3, 2e12, "rubber has 1e6 to 1e8, steel 2e11", pressures},
      {"torsion_modulus_pa", "Pa", 1e3, 2e12, "rubber has 3e5 to 3e7, steel 8e10", pressures},
      {"gravity_m_s2", "m/s^2", 0, 300, "the Earth has 9.81", {{"mm/s^2", 1e-3}}},
      {"mean_m_s", "m/s", 0, 120, "a hurricane has 33 and more", {{"km/h", 1 / 3.6}, {"mm/s", 1e-3}}},
      {"step_s", "s", 1e-6, 1, "", {{"ms", 1e-3}, {"us", 1e-6}}}};
  return rows;
}

const Plausible* find(const std::string& key) {
  const auto row = std::find_if(table().begin(), table().end(), [&](const Plausible& p) { return key == p.key; });
  return row == table().end() ? nullptr : &*row;
}

bool keeps(const Plausible& range, double value) {
  const double size = std::abs(value);
  return size == 0 || (size >= range.least && size <= range.most);
}

/// "; did you mean 50 mm, which is 0.05?", if that is plausible.
std::string other_unit(const Plausible& range, double value, double most) {
  for (const Unit& unit : range.others)
    if (keeps(range, value * unit.size) && std::abs(value * unit.size) <= most)
      return fmt::format("; did you mean {:g} {}, which is {:g}?", value, unit.name, value * unit.size);
  return "";
}

/// Every number that stands under a key, be it swept, with its own path.
void visit_numbers(const Json& value, const std::string& path,
                   const std::function<void(double, const std::string&)>& visit) {
  if (value.is_number()) return visit(value, path);
  if (value.is_array())
    for (std::size_t i = 0; i < value.size(); ++i) visit_numbers(value[i], element(path, i), visit);
  if (const std::string word = sweep_word(value); !word.empty()) visit_numbers(value[word], member(path, word), visit);
}

class Search {
 public:
  explicit Search(const Job& job) : job_(job) {}

  /// Objects of keys, whichever stand in place of each other.
  void look_at(const Json& value, const std::string& path) {
    if (value.is_array())
      for (std::size_t i = 0; i < value.size(); ++i) look_at(value[i], element(path, i));
    if (!value.is_object()) return;
    for (const char* across : {"length_m", "helix_radius_m", "mesh_m"}) look_at_thickness(value, path, across);
    for (const auto& [name, child] : value.items()) {
      if (name == "obstacles") continue;  // which may be of any size
      const Plausible* range = find(name);
      if (range == nullptr)
        look_at(child, member(path, name));
      else
        visit_numbers(child, member(path, name), [&](double number, const std::string& place) {
          if (!keeps(*range, number))
            warn(place, fmt::format("{:g} {} is outside of what is plausible, {:g} to {:g} {}{}{}", number, range->unit,
                                    range->least, range->most, range->unit,
                                    *range->known == '\0' ? "" : fmt::format(" ({})", range->known),
                                    other_unit(*range, number, range->most)));
        });
    }
  }

  std::vector<std::string> warnings;

 private:
  /// A rod that is thicker than what it is made of is long, at the worst of a sweep's values.
  void look_at_thickness(const Json& scene, const std::string& path, const char* across) {
    if (!scene.contains("radius_m") || !scene.contains(across)) return;
    double shortest = INFINITY, thickest = 0;
    std::string place;
    visit_numbers(scene[across], "", [&](double number, const std::string&) { shortest = std::min(shortest, number); });
    visit_numbers(scene["radius_m"], member(path, "radius_m"), [&](double number, const std::string& at) {
      if (number > thickest) thickest = number, place = at;
    });
    if (2 * thickest > shortest)
      warn(place, fmt::format("{:g} m makes a rod thicker than long, where {} is {:g} m{}", thickest, across, shortest,
                              other_unit(*find("radius_m"), thickest, shortest / 2)));
  }

  /// Once for a place.
  void warn(const std::string& place, const std::string& text) {
    const std::string begin = job_.path.string() + ": " + place + ": ";
    const auto is_here = [&](const std::string& warning) { return warning.rfind(begin, 0) == 0; };
    if (std::none_of(warnings.begin(), warnings.end(), is_here)) warnings.push_back(begin + text);
  }

  const Job& job_;
};

}  // namespace

std::vector<std::string> implausible_values(const Job& job) {
  Search search(job);
  for (const char* part : {"scene", "time"})
    if (job.values.contains(part)) search.look_at(job.values[part], part);
  return search.warnings;
}

}  // namespace rodsweep
