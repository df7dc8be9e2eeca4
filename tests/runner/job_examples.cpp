#include "tests/runner/job_examples.hpp"

#include <fstream>

namespace rodsweep {

Json bending_scene() {
  return Json::parse(R"({"type": "bending_rod", "segments": 10, "length_m": 2, "radius_m": 0.05, "density_kg_m3": 1000,
                         "youngs_modulus_pa": 1e5, "torsion_modulus_pa": 1e6})");
}

Json helix_scene() {
  return Json::parse(R"({"type": "helix", "segments": 45, "helix_radius_m": 0.5, "helix_height_m": 0.4, "windings": 2,
                         "radius_m": 0.05, "density_kg_m3": 1000, "youngs_modulus_pa": 1e6, "torsion_modulus_pa": 1e5})");
}

Json forest_scene() {
  return Json::parse(R"({"type": "forest", "rows": 1, "columns": 2, "spacing_m": 3, "depth": 1, "branches": 2,
                         "segments": 2, "length_m": 1, "radius_m": 0.05, "density_kg_m3": 1000,
                         "youngs_modulus_pa": 1e7, "torsion_modulus_pa": 1e7})");
}

Json two_rods(const std::filesystem::path& curves) {
  std::ofstream(curves) << "0,0,0\n1,0,0\n\n0,0,1\n0.6,0,1\n";
  return with("/curves", Json(curves.native()).dump(), Json::parse(R"({"type": "curves", "segment_m": 0.1,
              "held_at_m": [[0, 0, 0], [0, 0, 1]], "radius_m": 0.02, "density_kg_m3": 1000,
              "youngs_modulus_pa": 1e6, "torsion_modulus_pa": 1e6})"));
}

Json small_job() {
  return {{"name", "small"},
          {"kind", "sweep"},
          {"scene", bending_scene()},
          {"time", {{"step_s", 0.02}, {"steps", 10}}},
          {"guesses", {"zero", "previous"}}};
}

Json data_job() {
  return {{"name", "data"},
          {"kind", "dataset"},
          {"scene", bending_scene()},
          {"time", {{"step_s", 0.02}, {"steps", 4}, {"newton_iterations", 3}}}};
}

Json train_job() { return {{"name", "net"}, {"kind", "train"}, {"data", "data.h5"}}; }

Json with(const std::string& pointer, const std::string& value, Json job) {
  job[Json::json_pointer(pointer)] = Json::parse(value);
  return job;
}

Json without(const std::string& pointer, Json job) {
  const Json::json_pointer p(pointer);
  job[p.parent_pointer()].erase(p.back());
  return job;
}

Json grid(Json values) { return {{"grid", std::move(values)}}; }

Json zip(Json values) { return {{"zip", std::move(values)}}; }

Json uniform(double a, double b) { return {{"uniform", {a, b}}}; }

Job job_of(const Json& job) { return parse_job(job.dump(), "job.json"); }

Plan plan_of(const Json& job) { return Plan(job_of(job)); }

std::optional<ParameterColumn> find_column(const Plan& plan, const std::string& path) {
  for (const ParameterColumn& column : plan.parameters())
    if (column.path == path) return column;
  return std::nullopt;
}

std::string refusal_of_text(const std::string& text) {
  return message_of<JobError>([&] {
    const Job job = parse_job(text, "job.json");
    if (!is_training(job)) Plan plan(job);
  });
}

std::string refusal(const Json& job) { return refusal_of_text(job.dump()); }

}  // namespace rodsweep
