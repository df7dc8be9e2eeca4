// Files of curves: what is read from each format, what is refused with its line or key, and the rods that jobs make of them.
#include <fmt/format.h>

#include <string>

#include "runner/inputs/curve_file.hpp"
#include "runner/measure/plan_check.hpp"
#include "runner/plan/plan.hpp"
#include "tests/catch.hpp"
#include "tests/runner/job_folder.hpp"

namespace rodsweep::test_curve_file {

using Catch::Matchers::ContainsSubstring;
using Points = std::vector<Vector3>;

TEST_CASE("tables: columns, headers, comments, blank lines") {
  for (const char* text : {"0 0 0\n1 0 0\n\n0 1 0\n0 2 0.5\n", "x,y,z\r\n0,0,0\r\n1,0,0\r\n\r\n\r\n0,1,0\r\n0,2,.5\r\n",
                           "# two\n0;0;0 # start\n# inside\n1\t0 0\n\n0 1 0\n0 2 5e-1"}) {
    const std::vector<Curve> curves = parse_curves(text, "a.csv");
    REQUIRE(curves.size() == 2);
    CHECK(curves[0].points == Points{{0, 0, 0}, {1, 0, 0}});
    CHECK(curves[1].points == Points{{0, 1, 0}, {0, 2, 0.5}});
    CHECK(curves[1].radii.empty());
    CHECK(curves[1].name == "curve 2");
  }
  CHECK(parse_curves("x y z radius\n0 0 0 .1\n1 0 0 .2\n", "a.txt")[0].radii == std::vector<double>{0.1, 0.2});
  CHECK_THROWS_WITH(parse_curves("0 0 0\n1 0\n", "a.csv"), "a.csv:2: 2 values; must be x y z, or x y z radius");
  CHECK_THROWS_WITH(parse_curves("0 0 0\n1 0 0 1\n", "a.csv"),
                    "a.csv:2: 4 values; must be 3, as in the curve's first line");
  CHECK_THROWS_WITH(parse_curves("0 0 nan\n", "a.csv"), "a.csv:1: z is \"nan\"; must be a finite number");
  CHECK_THROWS_WITH(parse_curves("0 a 0\n", "a.csv"), ContainsSubstring("a.csv:1: y is \"a\""));
  CHECK_THROWS_WITH(parse_curves("\n\n", "a.csv"), "a.csv: has no curve");
}

TEST_CASE("tables: the names in a header decide, and an index without a name is left out") {
  for (const char* text :
       {",x,y,z\n0,1,2,3\n1,4,5,6\n", "z;X;y\n3;1;2\n6;4;5\n", "\"x\",\"y\",\"z\"\n\"1\",+2,3\n4,5,6\n",
        "x,y,z\r1,2,3\r4,5,6\r", ",Radius,x,y,z\n0,.1,1,2,3\n1,.1,4,5,6\n"}) {
    const std::vector<Curve> curves = parse_curves(text, "a.CSV");
    REQUIRE(curves.size() == 1);
    CHECK(curves[0].points == Points{{1, 2, 3}, {4, 5, 6}});
    if (!curves[0].radii.empty()) CHECK(curves[0].radii == std::vector<double>{0.1, 0.1});
  }
  CHECK(parse_curves("x,y,z\n0,0,0\n1,0,0\n,,\n0,1,0\n1,1,0\n", "a.csv").size() == 2);  // as spreadsheets write
  const auto refused = [](const char* text, const char* words) {
    CHECK_THROWS_WITH(parse_curves(text, "a.csv"), ContainsSubstring(words));
  };
  refused("x,y,z,diameter\n", "a.csv:1: column 4 is \"diameter\"; must be one of x, y, z and radius, each once");
  refused("x,y,,z\n", "a.csv:1: column 3 is \"\"");
  refused("x,y,x\n", "a.csv:1: column 3 is \"x\"");
  refused("x,y\n", "a.csv:1: no column is called \"z\"");
  refused("x,y,z\n0,0,0,1\n", "a.csv:2: 4 values; must be 3, as in the header");
  refused("0,0,0\n1,,0\n", "a.csv:2: y is \"\"; must be a finite number");
  refused("0,0,0\n1,0,0,\n", "a.csv:2: 4 values; must be 3");
}

TEST_CASE("JSON: radii, names and materials of each curve") {
  const std::vector<Curve> curves = parse_curves(
      R"({"curves": [{"name": "string", "points": [[0, 0, 0], [1, 0, 0]], "radius": 0.1, "density_kg_m3": 7},
                     {"points": [[0, 0, 0], [1, 0, 0.5]], "radius": [0.1, 0.2], "youngs_modulus_pa": 2e5,
                      "torsion_modulus_pa": 1e5}]})",
      "a.json");
  REQUIRE(curves.size() == 2);
  CHECK(curves[0].radii == std::vector<double>{0.1, 0.1});
  CHECK(curves[0].density_kg_m3 == 7);
  CHECK(curves[0].name == "curve \"string\"");
  CHECK(curves[1].points == Points{{0, 0, 0}, {1, 0, 0.5}});
  CHECK(curves[1].radii == std::vector<double>{0.1, 0.2});
  CHECK(curves[1].youngs_modulus_pa == 2e5);
  CHECK(curves[1].torsion_modulus_pa == 1e5);
  const auto refused = [](const char* text, const char* words) {
    CHECK_THROWS_WITH(parse_curves(text, "a.json"), ContainsSubstring(words));
  };
  refused(R"({"lines": []})", "a.json: curves: missing");
  refused(R"({"curves": [{"radius": 1}]})", "a.json: curves[0].points: missing");
  refused(R"({"curves": [{"points": [[0, 0, "1"]]}]})", "a.json: curves[0].points[0][2]: \"1\" is not allowed");
  refused(R"({"curves": [{"points": [[0, 0]]}]})",
          "a.json: curves[0].points[0]: [0,0] is not allowed; must be [x, y, z]");
  refused(R"({"curves": [{"points": [[0, 0, 0]], "radius": 0}]})",
          "a.json: curves[0].radius: 0 is not allowed; must be positive");
  refused(R"({"curves": [{"points": [[0, 0, 0]], "radius": [1, 2]}]})",
          "a.json: curves[0].radius: 2 values; must be one, or 1");
  refused(R"({"curves": [{"points": [[0, 0, 0]], "radii": 1}]})",
          "a.json: curves[0].radii: not allowed; a curve has points");
}

TEST_CASE("OBJ: lines between vertices, also counted from the end") {
  const std::vector<Curve> curves =
      parse_curves("o rod\nv 0 0 0\nv 1 0 0 1.0\nl 1 2\nv 2 0 0\nl -2/1 -1\nf 1 2 3\n", "a.obj");
  REQUIRE(curves.size() == 2);
  CHECK(curves[0].points == Points{{0, 0, 0}, {1, 0, 0}});
  CHECK(curves[1].points == Points{{1, 0, 0}, {2, 0, 0}});
  CHECK_THROWS_WITH(parse_curves("v 0 0 0\nl 1 2\n", "a.obj"),
                    "a.obj:2: a point of \"l\" is 2; must be the number of one of the 1 \"v\" above");
  CHECK_THROWS_WITH(parse_curves("v 0 0\n", "a.obj"), "a.obj:1: \"v\" needs x y z");
  CHECK_THROWS_WITH(parse_curves("v 0 0 0\n", "a.obj"), "a.obj: has no curve");
}

TEST_CASE("another ending is refused, for SWC with the scene that reads it") {
  CHECK_THROWS_WITH(parse_curves("", "a.stl"), ContainsSubstring("a.stl: the name ends in \".stl\"; must be .csv"));
  CHECK_THROWS_WITH(parse_curves("", "a.swc"), ContainsSubstring("the scene \"skeleton\" reads .swc"));
}

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
             ContainsSubstring("scene.curves: ") && ContainsSubstring("bow.csv:2: 2 values; must be x y z"));
  folder.write("bow.csv", "0 0 0\n1 0 0\n");
  CHECK_THAT(refusal_in(folder, curves_job(R"(, "held_at_m": [[0, 1, 0]])")),
             ContainsSubstring("scene: held_at_m has [0, 1, 0], which is no point of a curve"));
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
  CHECK_THAT(joined[0],
             ContainsSubstring("scene.join_m.grid[1]: points of bow.csv move by up to 0.005 m to where they meet"));
}

TEST_CASE("a star of very many curves from a free point is refused before its matrix is built") {
  const JobFolder folder;
  std::string star;
  for (int i = 0; i < 6000; ++i) star += fmt::format("0 0 0\n1 {} 0\n\n", i);
  folder.write("bow.csv", star.c_str());
  const Json job = with("/solve", R"({"method": "direct"})", without("/guesses", curves_job()));
  CHECK_THAT(message_of<JobError>([&] { check_factors(Plan(folder.job(job))); }),
             ContainsSubstring("scene: task 0: 5999 joints on one segment need 9.65 GiB") &&
                 ContainsSubstring("must be at most 4 GiB: hold the point where they meet"));
  const Json held = with("/scene/held_at_m", "[[0, 0, 0]]", job);
  CHECK_NOTHROW(check_factors(Plan(folder.job(held))));
}

}  // namespace rodsweep::test_curve_file
