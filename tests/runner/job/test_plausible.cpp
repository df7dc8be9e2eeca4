// Values that look like another unit are told, and no job of the project has one.
#include <catch2/catch.hpp>
#include <filesystem>

#include "runner/job/plausible.hpp"
#include "tests/runner/job_examples.hpp"

using namespace rodsweep;

namespace test_plausible {

std::vector<std::string> warnings(const Json& job) { return implausible_values(job_of(job)); }

using Texts = std::vector<std::string>;

TEST_CASE("a value outside of what real rods have is named with the unit that it may have been meant in") {
  CHECK(warnings(small_job()).empty());
  CHECK(
      warnings(with("/scene/radius_m", "50")) ==
      Texts{"job.json: scene.radius_m: 50 m makes a rod thicker than long, where length_m is 2 m; did you mean 50 mm, "
            "which is 0.05?"});
  CHECK(
      warnings(with("/scene/youngs_modulus_pa", "0.01")) ==
      Texts{"job.json: scene.youngs_modulus_pa: 0.01 Pa is outside of what is plausible, 1000 to 2e+12 Pa (rubber has "
            "1e6 to 1e8, steel 2e11); did you mean 0.01 GPa, which is 1e+07?"});
  CHECK(warnings(with("/time/step_s", "20")) ==
        Texts{"job.json: time.step_s: 20 s is outside of what is plausible, 1e-06 to 1 s; did you mean 20 ms, which is "
              "0.02?"});
  CHECK(warnings(with("/scene/density_kg_m3", "1")) ==
        Texts{"job.json: scene.density_kg_m3: 1 kg/m^3 is outside of what is plausible, 10 to 25000 kg/m^3 (water has "
              "1000, steel 7850); did you mean 1 g/cm^3, which is 1000?"});
  CHECK(warnings(with("/scene/density_kg_m3", "1000000")) ==
        Texts{"job.json: scene.density_kg_m3: 1e+06 kg/m^3 is outside of what is plausible, 10 to 25000 kg/m^3 (water "
              "has 1000, steel 7850); did you mean 1e+06 g/m^3, which is 1000?"});
  CHECK(warnings(with("/scene/gravity_m_s2", "[0, -9810, 0]")) ==
        Texts{"job.json: scene.gravity_m_s2[1]: -9810 m/s^2 is outside of what is plausible, 0 to 300 m/s^2 (the Earth "
              "has 9.81); did you mean -9810 mm/s^2, which is -9.81?"});
}

TEST_CASE("of a sweep every value counts, of a range its ends, and each place is named once") {
  CHECK(
      warnings(with("/scene/youngs_modulus_pa", R"({"log_uniform": [1, 1e6]})")) ==
      Texts{"job.json: scene.youngs_modulus_pa.log_uniform[0]: 1 Pa is outside of what is plausible, 1000 to 2e+12 Pa "
            "(rubber has 1e6 to 1e8, steel 2e11); did you mean 1 GPa, which is 1e+09?"});
  Json scenes = small_job();
  scenes["scene"] = grid({helix_scene(), with("/length_m", "1e6", bending_scene())});
  CHECK(
      warnings(scenes) ==
      Texts{"job.json: scene.grid[1].length_m: 1e+06 m is outside of what is plausible, 0.0001 to 1000 m; did you mean "
            "1e+06 mm, which is 1000?"});
  CHECK(warnings(with("/scene/radius_m", R"({"grid": [0.01, 1.5]})")) ==
        Texts{"job.json: scene.radius_m.grid[1]: 1.5 m makes a rod thicker than long, where length_m is 2 m; did you "
              "mean 1.5 mm, which is 0.0015?"});
}

TEST_CASE("no job of the project has a value that is not plausible") {
  for (const auto& entry : std::filesystem::directory_iterator(RODSWEEP_JOBS)) {
    if (entry.path().extension() != ".json" || entry.path().filename() == "schema.json") continue;
    CAPTURE(entry.path());
    CHECK(implausible_values(read_job(entry.path(), MissingFiles::accepted)) == Texts());
  }
}

}  // namespace test_plausible
