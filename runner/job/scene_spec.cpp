#include "runner/job/scene_spec.hpp"

#include <fmt/format.h>

#include "runner/job/choice.hpp"
#include "runner/job/contact_keys.hpp"
#include "runner/job/obstacle_keys.hpp"
#include "runner/job/skeleton_file.hpp"
#include "runner/job/tree_keys.hpp"
#include "runner/job/wind_keys.hpp"

namespace rodsweep {
namespace {

Vector3 vector(const Point& point, const char* path) {
  const Point::Value& value = point.at(path);
  return {value.number[0], value.number[1], value.number[2]};
}

void read_rod(const Point& point, RodParameters& rod) {
  static const std::map<std::string, Stretch> stretches{{"inextensible", Stretch::inextensible},
                                                        {"physical", Stretch::physical}};
  if (point.has("scene.radius_m")) rod.radius_m = point.number("scene.radius_m");
  rod.density_kg_m3 = point.number("scene.density_kg_m3");
  rod.youngs_modulus_pa = point.number("scene.youngs_modulus_pa");
  rod.torsion_modulus_pa = point.number("scene.torsion_modulus_pa");
  rod.gravity_m_s2 = vector(point, "scene.gravity_m_s2");
  rod.damping_per_s = point.number("scene.damping_per_s");
  rod.stretch = choice(stretches, point.text("scene.stretch"));
  rod.wind = wind_parameters(point);
  rod.contact = contact_settings(point);
  if (!point.is_text("scene.stretch_compliance_per_j")) {
    rod.stretch_compliance_per_j = point.number("scene.stretch_compliance_per_j");
  }
}

int segments(const Point& point) { return static_cast<int>(point.integer("scene.segments")); }

Clamp clamp(const Point& point) {
  static const std::map<std::string, Clamp> clamps{
      {"segment", Clamp::segment}, {"wall", Clamp::wall}, {"free", Clamp::free}};
  return choice(clamps, point.text("scene.clamp"));
}

void read_open_rod(const Point& point, OpenRod& rod) {
  read_rod(point, rod);
  rod.segments = segments(point);
  rod.clamp = clamp(point);
  rod.tip_force_n = vector(point, "scene.tip_force_n");
}

BendingRod bending_rod(const Point& point) {
  BendingRod rod;
  read_open_rod(point, rod);
  rod.length_m = point.number("scene.length_m");
  rod.initial_angle_deg = point.number("scene.initial_angle_deg");
  return rod;
}

Helix helix(const Point& point) {
  Helix rod;
  read_open_rod(point, rod);
  rod.helix_radius_m = point.number("scene.helix_radius_m");
  rod.helix_height_m = point.number("scene.helix_height_m");
  rod.windings = point.number("scene.windings");
  return rod;
}

Ring ring(const Point& point) {
  static const std::map<std::string, Ring::RestShape> shapes{{"straight", Ring::RestShape::straight},
                                                             {"circle", Ring::RestShape::circle}};
  Ring rod;
  read_rod(point, rod);
  rod.segments = segments(point);
  rod.clamp = clamp(point);
  rod.length_m = point.number("scene.length_m");
  rod.twist_deg = point.number("scene.twist_deg");
  rod.rest_shape = choice(shapes, point.text("scene.rest_shape"));
  return rod;
}

Net net(const Point& point) {
  static const std::map<std::string, Net::Held> held{
      {"side", Net::Held::side}, {"corners", Net::Held::corners}, {"free", Net::Held::free}};
  Net rods;
  read_rod(point, rods);
  rods.rows = static_cast<int>(point.integer("scene.rows"));
  rods.columns = static_cast<int>(point.integer("scene.columns"));
  rods.segments = segments(point);
  rods.mesh_m = point.number("scene.mesh_m");
  rods.held = choice(held, point.text("scene.held"));
  return rods;
}

void read_tree(const Point& point, Tree& tree) {
  read_rod(point, tree);
  tree.shape = tree_shape(point);
  tree.modulus_exponent = point.number("scene.modulus_exponent");
}

Tree tree(const Point& point) {
  Tree tree;
  read_tree(point, tree);
  return tree;
}

Forest forest(const Point& point) {
  Forest trees;
  read_tree(point, trees);
  trees.rows = static_cast<int>(point.integer("scene.rows"));
  trees.columns = static_cast<int>(point.integer("scene.columns"));
  trees.spacing_m = point.number("scene.spacing_m");
  trees.jitter = point.number("scene.jitter");
  return trees;
}

SkeletonTree skeleton_tree(const Point& point, const Job& job) {
  static const std::map<std::string, Up> ups{{"y", Up::y}, {"z", Up::z}};
  SkeletonTree tree;
  read_rod(point, tree);
  tree.modulus_exponent = point.number("scene.modulus_exponent");
  const InputFile& file = job.files.at(point.text("scene.skeleton"));
  try {
    tree.skeleton = std::make_shared<const Skeleton>(placed(*shared_skeleton(file.path, file.hash),
                                                            point.number("scene.skeleton_unit_m"),
                                                            choice(ups, point.text("scene.skeleton_up"))));
  } catch (const SkeletonError& error) {
    throw job_error(job.path, "scene.skeleton", error.what());
  }
  return tree;
}

template <class Spec>
SceneSpec with_rod(const Point& point, Spec spec) {
  read_rod(point, spec);
  return spec;
}

}  // namespace

SceneSpec scene_spec(const Point& point, const Job& job) {
  using Make = SceneSpec (*)(const Point&, const Job&);
  static const std::map<std::string, Make> scenes{
      {"bending_rod", [](const Point& p, const Job&) -> SceneSpec { return bending_rod(p); }},
      {"helix", [](const Point& p, const Job&) -> SceneSpec { return helix(p); }},
      {"ring", [](const Point& p, const Job&) -> SceneSpec { return ring(p); }},
      {"net", [](const Point& p, const Job&) -> SceneSpec { return net(p); }},
      {"tree", [](const Point& p, const Job&) -> SceneSpec { return tree(p); }},
      {"forest", [](const Point& p, const Job&) -> SceneSpec { return forest(p); }},
      {"skeleton", [](const Point& p, const Job& j) -> SceneSpec { return skeleton_tree(p, j); }},
      {"falling_rods", [](const Point& p, const Job&) { return with_rod(p, falling_rods(p)); }},
      {"coiling_rod", [](const Point& p, const Job&) { return with_rod(p, coiling_rod(p)); }},
      {"knot", [](const Point& p, const Job&) { return with_rod(p, knot(p)); }},
      {"ring_chain", [](const Point& p, const Job&) { return with_rod(p, ring_chain(p)); }},
      {"bundle", [](const Point& p, const Job&) { return with_rod(p, bundle(p)); }}};
  SceneSpec scene = choice(scenes, point.text("scene.type"))(point, job);
  std::visit([&](RodParameters& rod) { rod.obstacles = obstacles(point, job); }, scene);
  return scene;
}

void check_scene(const SceneSpec& scene, const Job& job) {
  const OpenRod* rod = open_rod(scene);
  if (rod && segment_count(scene) < 2) {
    throw job_error(
        job.path, "scene.segments",
        fmt::format("{} is not allowed with clamp \"{}\", since nothing is jointed; must be at least 2, or 1 with "
                    "clamp \"wall\"",
                    rod->segments, rod->clamp == Clamp::free ? "free" : "segment"));
  }
  try {
    validate(scene);
  } catch (const SceneError& error) {
    throw job_error(job.path, "scene", error.what());
  }
}

}  // namespace rodsweep
