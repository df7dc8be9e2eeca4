// Values that seem to be in another unit cause a warning. For the shipped jobs see job/test_shipped_jobs.cpp.

#include "tests/catch.hpp"
#include "tests/runner/job_examples.hpp"

using namespace rodsweep;

namespace test_plausible {

using Texts = std::vector<std::string>;

/// The job has one warning with these parts.
void check_warning(const Json& job, const Texts& parts) {
  const Texts warnings = job_of(job).warnings;
  REQUIRE(warnings.size() == 1);
  for (const std::string& part : parts) CHECK_THAT(warnings[0], Catch::Matchers::ContainsSubstring(part));
}

TEST_CASE("a value outside of what real rods have is named with the unit that it may have been meant in") {
  CHECK(job_of(small_job()).warnings.empty());
  check_warning(with("/scene/radius_m", "1.5"),
                {"job.json: scene.radius_m: 1.5 m", "length_m is 2 m", "1.5 mm, which is 0.0015"});
  check_warning(with("/scene/youngs_modulus_pa", "0.01"),
                {"scene.youngs_modulus_pa: 0.01 Pa", "1000 to 2e+12 Pa", "steel 2e11", "0.01 GPa, which is 1e+07"});
  check_warning(with("/time/step_s", "20"), {"time.step_s: 20 s", "1e-06 to 1 s", "20 ms, which is 0.02"});
  check_warning(with("/scene/density_kg_m3", "1"), {"scene.density_kg_m3", "1 g/cm^3, which is 1000"});
  check_warning(with("/scene/density_kg_m3", "1000000"), {"scene.density_kg_m3", "1e+06 g/m^3, which is 1000"});
  check_warning(with("/scene/gravity_m_s2", "[0, -9810, 0]"),
                {"scene.gravity_m_s2[1]: -9810 m/s^2", "-9810 mm/s^2, which is -9.81"});
}

TEST_CASE("of a sweep every value counts, and of a range its ends") {
  check_warning(with("/scene/youngs_modulus_pa", R"({"log_uniform": [1, 1e6]})"),
                {"scene.youngs_modulus_pa.log_uniform[0]: 1 Pa"});
  Json scenes = small_job();
  scenes["scene"] = grid({helix_scene(), with("/length_m", "1e6", bending_scene())});
  check_warning(scenes, {"scene.grid[1].length_m: 1e+06 m", "0.0001 to 1000 m", "1e+06 mm, which is 1000"});
  check_warning(with("/scene/radius_m", R"({"grid": [0.01, 1.5]})"), {"scene.radius_m.grid[1]: 1.5 m", "thicker"});
}

TEST_CASE("a point load on steps that do not balance momentum is warned of by its key") {
  const auto unbalanced = [](const char* path, const char* value) {
    return with(path, value, with("/time/balance", "false"));
  };
  const Json loaded = unbalanced("/scene/tip_force_n", "[0, -1, 0]");
  CHECK(job_of(with("/scene/tip_force_n", "[0, -1, 0]")).warnings.empty());
  check_warning(loaded, {"scene.tip_force_n: the rest shape", "time.step_s", "\"balance\": true"});
  check_warning(unbalanced("/scene/tip_torque_nm", "[1, 0, 0]"), {"scene.tip_torque_nm: the rest shape"});
  check_warning(unbalanced("/scene/tip_force_n", R"([{"grid": [0, 3]}, 0, 0])"), {"scene.tip_force_n: "});
  Json scenes = with("/time/balance", "false");
  scenes["scene"] = grid({helix_scene(), with("/tip_force_n", "[1, 0, 0]", bending_scene())});
  check_warning(scenes, {"scene.grid[1].tip_force_n: "});
  for (const char* balance : {"true", R"({"grid": [false, true]})"})
    CHECK(job_of(with("/time/balance", balance, loaded)).warnings.empty());
  for (const auto& [second, warnings] : {std::pair("false", 1u), {"true", 0u}}) {  // `time` as a whole can be swept
    Json times = loaded;
    times["time"] = grid({loaded["time"], with("/balance", second, loaded["time"])});
    CHECK(job_of(times).warnings.size() == warnings);
  }
  CHECK(job_of(unbalanced("/scene/tip_force_n", "[0, 0, 0]")).warnings.empty());
  const char* lattice =  // its loads are at centres of segments
      R"({"type": "lattice", "nodes_x": 3, "segments": 2, "mesh_m": 0.5, "radius_m": 0.05, "density_kg_m3": 1000,
          "youngs_modulus_pa": 1e6, "torsion_modulus_pa": 1e6, "tip_force_n": [0, -2, 1]})";
  CHECK(job_of(unbalanced("/scene", lattice)).warnings.empty());
}

TEST_CASE("what twists or spins a rod in steps that do not balance momentum is warned of by its key") {
  const char* motion = R"([{"at_m": [0, 0, 0], "times_s": [0, 1], "factors": [0, 1], "displacement_m": [0, 1, 0]},
                           {"at_m": [0, 0, 0], "times_s": [0, 1], "factors": [0, 1], "rotation_deg": [90, 0, 0]}])";
  const Json plain = with("/time/balance", "false");
  const Json tip = with("/scene/tip_motion", R"({"duration_s": 1, "rotation_deg": [{"grid": [0, 90]}, 0, 0]})", plain);
  check_warning(tip, {"scene.tip_motion.rotation_deg: a rod that is twisted or spun", "\"balance\": true"});
  check_warning(with("/scene/motions", motion, plain), {"scene.motions[1].rotation_deg: "});
  const Json ring = Json::parse(R"({"type": "ring", "segments": 12, "length_m": 3, "radius_m": 0.05, "twist_deg": 90,
                                    "density_kg_m3": 1000, "youngs_modulus_pa": 1e6, "torsion_modulus_pa": 5e5})");
  check_warning(with("/scene", ring.dump(), plain), {"scene.twist_deg: "});
  CHECK(job_of(with("/time/balance", "true", tip)).warnings.empty());
  CHECK(job_of(with("/scene/tip_motion", R"({"duration_s": 1, "displacement_m": [-0.1, 0, 0]})", plain))
            .warnings.empty());
}

TEST_CASE("a load that jumps within a step of BDF2 is warned of by its time") {
  const auto loaded = [](const char* times, const char* integrator) {
    Json job = with("/time/balance", "true", with("/time/integrator", integrator));
    job["scene"]["loads"] = Json::array({{{"at_m", {1, 0, 0}}, {"force_n", {0, 1, 0}}, {"factors", {1, 1, 0}}}});
    job["scene"]["loads"][0]["times_s"] = Json::parse(times);
    return job;
  };
  check_warning(loaded("[0, 1, 1.001]", "\"bdf2\""),
                {"scene.loads[0].times_s[2]: the load jumps within a step of 0.02 s", "half a step too long"});
  check_warning(loaded("[0, 1, 1.001]", R"({"grid": ["euler", "bdf2"]})"), {"scene.loads[0].times_s[2]: "});
  Json times = loaded("[0, 1, 1.001]", "\"euler\"");
  times["time"] = grid({times["time"], with("/integrator", "\"bdf2\"", times["time"])});
  check_warning(times, {"scene.loads[0].times_s[2]: "});
  CHECK(job_of(loaded("[0, 1, 1.1]", "\"bdf2\"")).warnings.empty());
  CHECK(job_of(loaded("[0, 1, 1.001]", "\"euler\"")).warnings.empty());
}

}  // namespace test_plausible
