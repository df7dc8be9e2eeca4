#include "runner/job/job.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "runner/inputs/curve_file.hpp"
#include "runner/inputs/skeleton_file.hpp"
#include "runner/keys/sweep_words.hpp"
#include "runner/specs/scene_keys.hpp"
#include "runner/text/job_error.hpp"

namespace rodsweep {
namespace {

using Json = nlohmann::ordered_json;

/// Adds a line about a key. `text`: maybe a format and its values.
template <class... Text>
void warn(std::vector<std::string>& warnings, const std::filesystem::path& file, const std::string& key,
          const Text&... text) {
  warnings.emplace_back(job_error(file, key, text...).what());
}

/// Calls `visit(object, path)` for an object, or for each of a sweep of objects.
template <class Visit>
void visit_objects(const Json& value, const std::string& path, const Visit& visit) {
  const std::string word = sweep_word(value);
  if (word.empty()) return visit(value, path);
  for (std::size_t i = 0; i < value[word].size(); ++i)
    visit_objects(value[word][i], element(member(path, word), i), visit);
}

/// The single values that a key can take in a validated job, each with its path.
void visit_values(const Json& value, const std::string& path,
                  const std::function<void(const Json&, const std::string&)>& visit) {
  if (value.is_null()) return;
  const std::string word = sweep_word(value);
  const Json& items = word.empty() ? value : value[word];
  if (!items.is_array()) return visit(value, path);
  for (std::size_t i = 0; i < items.size(); ++i)
    visit_values(items[i], element(word.empty() ? path : member(path, word), i), visit);
}

void visit_numbers(const Json& value, const std::string& path,
                   const std::function<void(double, const std::string&)>& visit) {
  visit_values(value, path, [&](const Json& each, const std::string& at) {
    if (each.is_number()) visit(each, at);
  });
}

/// Whether a list has an item, or a list of a sweep.
bool has_item(const Json& list) {
  const std::string word = sweep_word(list);
  return word.empty() ? !list.empty() : std::any_of(list[word].begin(), list[word].end(), has_item);
}

bool may_be_nonzero(const Json& numbers) {
  bool found = false;
  visit_numbers(numbers, "", [&](double number, const std::string&) { found |= number != 0; });
  return found;
}

/// The path of the first motion with a rotation, or of the first other key that twists rods; "" if there is none.
std::string what_twists(const Json& scene, const std::string& path) {
  std::string found;
  const auto look = [&](const Json& motions, const std::string& key) {
    visit_values(motions, member(path, key), [&](const Json& motion, const std::string& at) {
      if (found.empty() && motion.is_object() && may_be_nonzero(motion.value("rotation_deg", Json())))
        found = member(at, "rotation_deg");
    });
  };
  look(scene.value("tip_motion", Json()), "tip_motion");
  look(scene["motions"], "motions");
  if (found.empty() && may_be_nonzero(scene.value("twist_deg", Json()))) found = member(path, "twist_deg");
  return found;
}

/// For each scene with a rod thicker than long, at the worst of a sweep's values.
std::vector<std::string> thick_rods(const Json& scenes, const std::filesystem::path& file) {
  const Key& radius = *find_key(scene_keys().keys(), "radius_m");
  std::vector<std::string> warnings;
  visit_objects(scenes, "scene", [&](const Json& scene, const std::string& path) {
    double thickest = 0;
    std::string place;
    visit_numbers(scene.value("radius_m", Json()), member(path, "radius_m"), [&](double number, const std::string& at) {
      if (number > thickest) thickest = number, place = at;
    });
    for (const char* across : {"length_m", "helix_radius_m", "mesh_m"}) {
      double shortest = INFINITY;
      visit_numbers(scene.value(across, Json()), "",
                    [&](double number, const std::string&) { shortest = std::min(shortest, number); });
      if (2 * thickest > shortest)
        warn(warnings, file, place, "{:g} m makes a rod thicker than long: {} is {:g} m{}", thickest, across, shortest,
             other_unit(radius, thickest, shortest / 2));
    }
  });
  return warnings;
}

/// What was assumed to read the job's skeletons.
std::vector<std::string> assumed_of_skeletons(const Job& job) {
  std::vector<std::string> warnings;
  for (const auto& [written, file] : job.files) {
    if (file.hash.empty() || !file.is_used_as(FileKind::skeleton)) continue;
    try {
      for (const std::string& warning : shared_skeleton(file.path, file.hash).warnings) warnings.push_back(warning);
    } catch (const SkeletonError&) {  // the plan refuses it
    }
  }
  return warnings;
}

/// How far points of curves move to meet within `join_m`, at most.
std::vector<std::string> joined_curves(const Job& job) {
  std::vector<std::string> warnings;
  visit_objects(job.values["scene"], "scene", [&](const Json& scene, const std::string& path) {
    double farthest = 0;
    std::string place;
    visit_numbers(scene.value("join_m", Json()), member(path, "join_m"), [&](double join_m, const std::string& at) {
      if (join_m > farthest) farthest = join_m, place = at;
    });
    if (farthest == 0) return;
    visit_values(scene["curves"], "", [&](const Json& written, const std::string&) {
      const InputFile& file = job.files.at(written);
      if (file.hash.empty()) return;
      visit_numbers(scene["curves_unit_m"], "", [&](double unit_m, const std::string&) {
        try {
          const double shift = unit_m * joining_shift(shared_curves(file.path, file.hash), farthest / unit_m);
          if (shift > 0)
            warn(warnings, job.path, place, "points of {} move by up to {:.3g} m to where they meet",
                 written.get<std::string>(), shift);
        } catch (const CurveError&) {  // the plan refuses it
        } catch (const SceneError&) {
        }
      });
    });
  });
  return warnings;
}

/// For each load that changes within a step of BDF2, which then acts for half a step too long.
std::vector<std::string> jumping_loads(const Json& values, const std::filesystem::path& file) {
  bool may_be_bdf2 = false;
  double step_s = 0;
  visit_objects(values["time"], "time", [&](const Json& time, const std::string&) {
    visit_values(time["integrator"], "", [&](const Json& word, const std::string&) { may_be_bdf2 |= word == "bdf2"; });
    visit_numbers(time["step_s"], "", [&](double number, const std::string&) { step_s = std::max(step_s, number); });
  });
  if (!may_be_bdf2) return {};
  std::vector<std::string> warnings;
  const auto look = [&](const Json& load, const std::string& path) {
    if (!load.is_object()) return;
    const Json times_s = load.value("times_s", Json()), factors = load.value("factors", Json());
    if (!times_s.is_array() || !factors.is_array() || times_s.size() != factors.size()) return;
    for (std::size_t i = 1; i < times_s.size(); ++i) {
      const Json &from_s = times_s[i - 1], &to_s = times_s[i];
      if (!from_s.is_number() || !to_s.is_number() || factors[i - 1] == factors[i]) continue;
      if (to_s.get<double>() - from_s.get<double>() >= step_s) continue;
      warn(warnings, file, element(member(path, "times_s"), i),
           "the load jumps within a step of {:g} s, and with integrator \"bdf2\" the old one acts for half a step too "
           "long; let it change over some steps",
           step_s);
    }
  };
  visit_objects(values["scene"], "scene", [&](const Json& scene, const std::string& path) {
    visit_values(scene["loads"], member(path, "loads"), look);
  });
  return warnings;
}

/// For each load at a point, and for each scene that is twisted or spun, in steps that do not balance momentum, if the
/// method could.
std::vector<std::string> unbalanced_loads(const Json& values, const std::filesystem::path& file) {
  const Json method = values.value("solve", Json::object()).value("method", Json("direct"));  // data sets have none
  bool balances = false;
  visit_objects(values["time"], "time",
                [&](const Json& time, const std::string&) { balances |= time["balance"] != false; });
  if (balances || (method.is_string() && method != "cg" && method != "direct")) return {};
  std::vector<std::string> warnings;
  const auto unbalanced = [&](const std::string& path, const char* what, const char* also = "") {
    warn(warnings, file, path, "{}; set \"balance\": true{} in \"time\" (methods direct and cg)", what, also);
  };
  visit_objects(values["scene"], "scene", [&](const Json& scene, const std::string& path) {
    for (const char* load : {"tip_force_n", "tip_torque_nm", "loads"}) {
      if (scene["type"] == Lattice::name && load == std::string("tip_force_n")) continue;  // at centres of segments
      if ((std::string(load) == "loads" && has_item(scene["loads"])) || may_be_nonzero(scene.value(load, Json())))
        unbalanced(member(path, load),
                   "the rest shape under a point load depends on time.step_s, most of all near buckling");
    }
    if (const std::string twist = what_twists(scene, path); !twist.empty())
      unbalanced(twist,
                 "a rod that is twisted or spun can sag or lag many times too far unless time.step_s is very short",
                 " and, for spin, \"integrator\": \"bdf2\"");
  });
  return warnings;
}

}  // namespace

void check_obstacles(const Json& scenes, const std::filesystem::path& file) {
  visit_objects(scenes, "scene", [&](const Json& scene, const std::string& path) {
    if (scene["contact"] == "none" && has_item(scene["obstacles"]))
      throw job_error(file, member(path, "obstacles"),
                      "rods without \"contact\" pass through obstacles; give the scene \"contact\": {\"friction\": "
                      "0.3}, or remove this key");
  });
}

std::vector<std::string> scene_warnings(const Job& job) {
  std::vector<std::string> all;
  for (const std::vector<std::string>& some :
       {thick_rods(job.values["scene"], job.path), assumed_of_skeletons(job), joined_curves(job),
        unbalanced_loads(job.values, job.path), jumping_loads(job.values, job.path)})
    all.insert(all.end(), some.begin(), some.end());
  return all;
}

}  // namespace rodsweep
