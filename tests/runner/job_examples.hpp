// Jobs for tests: a small valid one to alter, and the text with which an altered one is refused.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "runner/job/plan.hpp"

namespace rodsweep {

using Json = nlohmann::ordered_json;

inline Json bending_scene() {
  return Json::parse(R"({"type": "bending_rod", "segments": 10, "length_m": 2, "radius_m": 0.05, "density_kg_m3": 1000,
                         "youngs_modulus_pa": 1e5, "torsion_modulus_pa": 1e6})");
}

inline Json helix_scene() {
  return Json::parse(R"({"type": "helix", "segments": 45, "helix_radius_m": 0.5, "helix_height_m": 0.4, "windings": 2,
                         "radius_m": 0.05, "density_kg_m3": 1000, "youngs_modulus_pa": 1e6, "torsion_modulus_pa": 1e5})");
}

/// Two small trees, a rod each.
inline Json forest_scene() {
  return Json::parse(R"({"type": "forest", "rows": 1, "columns": 2, "spacing_m": 3, "depth": 1, "branches": 2,
                         "segments": 2, "length_m": 1, "radius_m": 0.05, "density_kg_m3": 1000,
                         "youngs_modulus_pa": 1e7, "torsion_modulus_pa": 1e7})");
}

inline Json small_job() {
  return {{"name", "small"},
          {"kind", "sweep"},
          {"scene", bending_scene()},
          {"time", {{"step_s", 0.02}, {"steps", 10}}},
          {"guesses", {"zero", "previous"}}};
}

/// The same rod as a data set.
inline Json data_job() {
  return {{"name", "data"},
          {"kind", "dataset"},
          {"scene", bending_scene()},
          {"time", {{"step_s", 0.02}, {"steps", 4}, {"newton_iterations", 3}}}};
}

/// A network that learns from a data set.
inline Json train_job() { return {{"name", "net"}, {"kind", "train"}, {"data", "data.h5"}}; }

/// The small job with the JSON text `value` at a JSON pointer such as "/scene/segments".
inline Json with(const std::string& pointer, const std::string& value, Json job = small_job()) {
  job[Json::json_pointer(pointer)] = Json::parse(value);
  return job;
}

inline Json without(const std::string& pointer, Json job = small_job()) {
  const Json::json_pointer p(pointer);
  job[p.parent_pointer()].erase(p.back());
  return job;
}

inline Json grid(Json values) { return {{"grid", std::move(values)}}; }
inline Json zip(Json values) { return {{"zip", std::move(values)}}; }
inline Json uniform(double a, double b) { return {{"uniform", {a, b}}}; }

inline Job job_of(const Json& job) { return parse_job(job.dump(), "job.json"); }
inline Plan plan_of(const Json& job) { return Plan(job_of(job)); }

/// What the user is told, "" if nothing is wrong.
inline std::string refusal_of_text(const std::string& text) {
  try {
    const Job job = parse_job(text, "job.json");
    if (!is_training(job)) Plan plan(job);
  } catch (const JobError& e) {
    return e.what();
  }
  return "";
}

inline std::string refusal(const Json& job) { return refusal_of_text(job.dump()); }

}  // namespace rodsweep
