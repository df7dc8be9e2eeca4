// Curves from files, and loads, motions and changes of gravity in jobs.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <string>

#include "runner/measure/plan_check.hpp"
#include "runner/plan/plan.hpp"
#include "tests/runner/job_folder.hpp"

namespace rodsweep {
namespace test_job_curves {

using Catch::Contains;

Json curves_job(const std::string& more = "") {
  return with("/scene", R"({"type": "curves", "curves": "bow.csv", "radius_m": 0.01, "density_kg_m3": 800,
      "youngs_modulus_pa": 1e9, "torsion_modulus_pa": 1e8)" +
                            more + "}");
}

std::string refusal_in(const JobFolder& folder, const Json& job) {
  return message_of<JobError>([&] { check_scene(Plan(folder.job(job)).spec(0).scene, folder.job(job)); });
}

TEST_CASE("a file of curves beside the job becomes rods") {
  const JobFolder folder;
  folder.write("bow.csv", "0 0 0\n100 0 0\n\n100 0 0\n100 50 0\n");
  const Json job = curves_job(R"(, "curves_unit_m": 0.01, "segment_m": 0.1, "held_at_m": [[0, 0, 0]])");
  const Plan plan(folder.job(job));
  CHECK(plan.task(0).segments == 16);  // with the clamp
  CHECK(plan.task(0).joints == 15);
  const Scene scene = build_scene(plan.spec(0).scene);
  CHECK(scene.rods.size() == 1);
  CHECK((scene.rods[0].position.back() - Vector3(0, 0, 0)).norm() < 1e-15);
}

TEST_CASE("mistakes in a file of curves, or in what is held, are told with file and line") {
  const JobFolder folder;
  folder.write("bow.csv", "0 0 0\n1 0\n");
  CHECK_THAT(refusal_in(folder, curves_job()),
             Contains("scene.curves: ") && Contains("bow.csv:2: 2 values; must be x y z"));
  folder.write("bow.csv", "0 0 0\n1 0 0\n");
  CHECK_THAT(refusal_in(folder, curves_job(R"(, "held_at_m": [[0, 1, 0]])")),
             Contains("scene: held_at_m has [0, 1, 0], which is no point of a curve"));
}

TEST_CASE("how far points move to meet within join_m is told") {
  const JobFolder folder;
  folder.write("bow.csv", "0 0 0\n100 0 0\n\n101 0 0\n100 50 0\n");
  const auto warnings = [&](const std::string& more) {
    return folder.job(curves_job(R"(, "curves_unit_m": 0.01)" + more)).warnings;
  };
  CHECK(warnings("").empty());
  CHECK(warnings(R"(, "join_m": 0.001)").empty());
  const auto joined = warnings(R"(, "join_m": {"grid": [0, 0.02]})");
  REQUIRE(joined.size() == 1);
  CHECK_THAT(joined[0], Contains("scene.join_m.grid[1]: points of bow.csv move by up to 0.005 m to where they meet"));
}

TEST_CASE("a star of very many curves from a free point is refused before its matrix is built") {
  const JobFolder folder;
  std::string star;
  for (int i = 0; i < 6000; ++i) star += fmt::format("0 0 0\n1 {} 0\n\n", i);
  folder.write("bow.csv", star.c_str());
  const Json job = with("/solve", R"({"method": "direct"})", without("/guesses", curves_job()));
  CHECK_THAT(message_of<JobError>([&] { check_factors(Plan(folder.job(job))); }),
             Contains("scene: task 0: 5999 joints on one segment need 9.65 GiB") &&
                 Contains("must be at most 4 GiB: hold the point where they meet"));
  const Json held = with("/scene/held_at_m", "[[0, 0, 0]]", job);
  CHECK_NOTHROW(check_factors(Plan(folder.job(held))));
}

TEST_CASE("loads, motions and changes of gravity are read, and their values may be sweeps") {
  const Plan plan = plan_of(with("/scene/loads", R"([
      {"at_m": [1, 0, 0], "force_n": [0, {"grid": [-1, -2]}, 0], "times_s": [0, 1], "factors": [0, 3], "smooth": true},
      {"at_m": [0.5, 0, 0], "torque_nm": [1, 0, 0]}])"));
  REQUIRE(plan.size() == 2);
  const Prescribed read = rod_parameters(plan.spec(1).scene).prescribed;
  REQUIRE(read.loads.size() == 2);
  CHECK(read.loads[0].force_n == Vector3(0, -2, 0));
  CHECK(read.loads[0].schedule.at(2) == 3);
  CHECK(read.loads[0].schedule.smooth);
  CHECK(read.loads[1].torque_nm == Vector3(1, 0, 0));
  CHECK(read.loads[1].schedule.at(2) == 1);
  CHECK(plan.inputs(0).trajectory != plan.inputs(1).trajectory);
  const Plan moved =
      plan_of(with("/scene/motions", R"([{"at_m": [0, 0, 0], "rotation_deg": [90, 0, 0], "times_s": [0, 1],
      "factors": [0, 1]}])",
                   with("/scene/gravity_changes", R"([{"by_m_s2": [0, 9.81, 0]}])")));
  const Prescribed other = rod_parameters(moved.spec(0).scene).prescribed;
  CHECK(other.motions.at(0).rotation_deg == Vector3(90, 0, 0));
  CHECK(other.gravity.at(0).by_m_s2 == Vector3(0, 9.81, 0));
  const Prescribed nothing = rod_parameters(plan_of(small_job()).spec(0).scene).prescribed;
  CHECK((nothing.loads.empty() && nothing.motions.empty() && nothing.gravity.empty()));
}

}  // namespace test_job_curves
}  // namespace rodsweep
