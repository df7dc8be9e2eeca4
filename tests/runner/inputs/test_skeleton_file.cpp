// Files of skeletons in SWC: what is read, assumed and refused, and the trees that jobs make of them.
#include <string>

#include "runner/inputs/skeleton_file.hpp"
#include "tests/catch.hpp"
#include "tests/runner/job_folder.hpp"

namespace rodsweep {
namespace test_skeleton_file {

Json skeleton_job(const std::string& more = "") {
  return with("/scene", R"({"type": "skeleton", "skeleton": "plum.swc", "density_kg_m3": 800,
      "youngs_modulus_pa": 1e9, "torsion_modulus_pa": 1e8)" +
                            more + "}");
}

constexpr const char* plum = R"(# a plum, in centimetres, z up
7 0 10 0 0 3 -1
8 0 10 0 50 3 7   # the trunk

2 0 30 0 90 2 8
3 0 -10 20 90 2 8
)";

std::string refusal_of_skeleton(const std::string& text) {
  return message_of<SkeletonError>([&] { parse_skeleton(text, "plum.swc"); });
}

TEST_CASE("a skeleton is found beside the job; units, axis and root are brought to the scene's") {
  const JobFolder folder;
  folder.write("plum.swc", plum);
  const Plan plan(folder.job(skeleton_job(R"(, "skeleton_unit_m": 0.01, "skeleton_up": "z")")));
  CHECK(plan.task(0).segments == 4);
  CHECK(plan.task(0).joints == 3);
  const SkeletonTree plum_tree = std::get<SkeletonTree>(plan.spec(0).scene);
  const Skeleton& read = plum_tree.trees->front();
  const Skeleton skeleton = placed(read, read.front().position_m, plum_tree.unit_m, plum_tree.up);
  CHECK(skeleton[0].position_m.norm() == 0);
  CHECK((skeleton[1].position_m - Vector3(0, 0.5, 0)).norm() < 1e-15);
  CHECK((skeleton[3].position_m - Vector3(-0.2, 0.9, -0.2)).norm() < 1e-15);
  CHECK(skeleton[2].parent == 1);
  CHECK(skeleton[2].radius_m == Approx(0.02).epsilon(1e-15));
  const Rod rod = build_scene(plan.spec(0).scene).rods.front();
  CHECK(rod.segments[1].radius_m == Approx(0.03).epsilon(1e-15));
}

TEST_CASE("a skeleton that is none is refused with file, line, value and bound") {
  CHECK(refusal_of_skeleton(plum).empty());
  CHECK(refusal_of_skeleton("") == "plum.swc:0: 0 nodes; must be at least 2");
  const std::vector<std::pair<std::string, std::string>> after_first_line{
      {"2 0 0 1 0 1\n", "2: 6 values; must be the 7 of SWC: id type x y z radius parent"},
      {"2 0 0 1m 0 1 1\n", "2: y is \"1m\"; must be a finite number"},
      {"2 0 0 nan 0 1 1\n", "2: y is \"nan\"; must be a finite number"},
      {"1.5 0 0 0 0 1 1\n", "2: id is \"1.5\"; must be an integer"},
      {"2 0 0 1 0 1 3\n4 0 0 2 0 1 1\n", "2: parent is 3; must be the id of another line, or -1 for a root"},
      {"2 0 0 1 0 1 2\n", "2: parent is 2; must be the id of another line, or -1 for a root"},
      {"1 0 0 1 0 1 1\n", "2: id is 1, as in line 1; must be another"},
      {"\n2 0 0 1 0 -1 1\n", "3: radius is -1; must be at least 0"},
      {"2 0 0 1 0 1 3\n3 0 0 2 0 1 2\n",
       "2: parent is 3, below which this node is: a loop; one of its nodes must have the parent -1"},
      {"2 0 0 0 0 1 1\n", "2: no node is away from its root; must be a tree"},
  };
  for (const auto& [lines, says] : after_first_line)
    CHECK(refusal_of_skeleton("1 0 0 0 0 1 -1\n" + lines) == "plum.swc:" + says);
  CHECK(refusal_of_skeleton("1 0 0 0 0 0 -1\n2 0 0 1 0 0 1\n") ==
        "plum.swc:1: radius is 0, as those around; must be positive");
  const JobFolder folder;
  folder.write("plum.swc", "1 0 0 0\n");
  CHECK(folder.refusal(skeleton_job()) == (folder.path() / "job.json").native() +
                                              ": scene.skeleton: " + (folder.path() / "plum.swc").native() +
                                              ":1: 4 values; must be the 7 of SWC: id type x y z radius parent");
}

TEST_CASE("a skeleton is the same however its lines are written") {
  const std::string plain = "1 0 0 0 0 5 -1\n2 0 0 0 3 5 1\n3 0 0 0 6 4 2\n4 0 1 0 9 3 3\n5 0 -1 0 9 3 3\n";
  const Skeleton expected = parse_skeleton(plain, "plum.swc").trees.at(0);
  REQUIRE(expected.size() == 5);
  const auto replaced = [&](const std::string& from, const std::string& to) {
    std::string text = plain;
    for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
      text.replace(at, from.size(), to);
    return text;
  };
  const std::string big = "720575940626407427";
  for (const std::string& text :
       {replaced(" ", ","), replaced(" ", "\t"), replaced("\n", "\r\n"), replaced("\n", "\r"), replaced("\n", "\n\n"),
        "\xEF\xBB\xBF# c\n" + plain, replaced("1 0 ", "1.0 0.0 "), replaced(" 3 3\n", " 3 3 9\n"),
        replaced("3 0 0 0 6", big + " 0 0 0 6"), plain.substr(15) + plain.substr(0, 15)}) {
    CAPTURE(text);
    std::string own = text;
    if (text.find(big) != std::string::npos)
      for (std::size_t at = 0; (at = own.find(" 3 3\n", at)) != std::string::npos; at += 3)
        own.replace(at, 5, " 3 " + big + "\n");
    const SkeletonFile read = parse_skeleton(own, "plum.swc");
    REQUIRE(read.trees.size() == 1);
    REQUIRE(read.trees[0].size() == expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
      CHECK(read.trees[0][i].parent == expected[i].parent);
      CHECK(read.trees[0][i].position_m == expected[i].position_m);
      CHECK(read.trees[0][i].radius_m == expected[i].radius_m);
    }
  }
}

TEST_CASE("what is assumed of a skeleton is said") {
  const auto assumed = [](const std::string& text) {
    const SkeletonFile read = parse_skeleton(text, "plum.swc");
    return read.warnings.size() == 1 ? read.warnings.front() : std::to_string(read.warnings.size()) + " warnings";
  };
  const std::string root = "1 0 0 0 0 5 -1\n";
  CHECK(assumed(root + "2 0 0 0 3 0 1\n") == "plum.swc:2: a radius of 0 is that of the node below");
  CHECK(assumed(root + "2 0 0 0 0 5 1\n3 0 0 0 3 5 2\n4 0 0 0 3 5 3\n") ==
        "plum.swc: a node at the place of its parent is left out (in 2 lines; first: 2)");
  CHECK(assumed(root + "2 0 0 0 3 5 1 7\n") == "plum.swc:2: columns after the 7 of SWC are ignored");
  CHECK(assumed("7 0 9 9 9 1 -1\n" + root + "2 0 0 0 3 5 1\n") == "plum.swc:1: a root without branches is left out");
  const SkeletonFile cell =
      parse_skeleton("1 1 0 0 0 5 -1\n2 1 0 -5 0 5 1\n3 1 0 5 0 5 1\n4 3 5 10 0 1 1\n5 3 30 30 0 1 4\n", "cell.swc");
  CHECK(cell.trees.at(0).size() == 3);
  CHECK(cell.warnings == std::vector<std::string>{"cell.swc:2: a soma of three points is its centre"});

  const JobFolder folder;
  folder.write("plum.swc", "1 0 0 0 0 5 -1\n2 0 0 3 0 0 1\n3 0 9 0 0 5 -1\n4 0 9 4 0 5 3\n5 0 9 8 0 5 4\n");
  const Job job = folder.job(skeleton_job());
  REQUIRE_FALSE(job.warnings.empty());
  CHECK_THAT(job.warnings.back(), Catch::Matchers::ContainsSubstring("plum.swc:2: a radius of 0"));
  const Plan plan(job);
  CHECK(plan.task(0).segments == 5);  // two rods
  CHECK(plan.task(0).joints == 3);
  const Scene scene = build_scene(plan.spec(0).scene);
  REQUIRE(scene.rods.size() == 2);
  CHECK((scene.rods[1].position[0] - Vector3(9, 0, 0)).norm() < 1e-12);
}

}  // namespace test_skeleton_file
}  // namespace rodsweep
