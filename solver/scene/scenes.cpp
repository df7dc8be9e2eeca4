#include "solver/scene/scenes.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "solver/scene/scene_parts.hpp"

namespace rodsweep {

static void check_section(const RodParameters& p) {
  if (const auto* tube = std::get_if<Tube>(&*p.section); tube && tube->wall_m > p.radius_m)
    require(false, "section.wall_m", tube->wall_m, ("at most radius_m, " + std::to_string(p.radius_m)).c_str());
  const CrossSection of = cross_section(p);
  const auto check = [](const char* what, double value) {
    require(std::isnormal(value), what, value, "a number that can be divided by; make the section larger");
  };
  check("section: the area [m^2]", of.area_m2);
  check("section: a second moment [m^4]", std::min(of.second_moment_x_m4, of.second_moment_y_m4));
  check("section: the torsion constant [m^4]", of.torsion_constant_m4);
}

void validate(const SceneSpec& spec) {
  std::visit([](const auto& scene) { scene.check(); }, spec);
  const RodParameters& p = rod_parameters(spec);
  if (p.stretch == Stretch::physical && p.stretch_compliance_per_j)
    throw SceneError("stretch is physical, but stretch_compliance_per_j is given too; must be one of them");
  if (p.section) check_section(p);
  p.prescribed.check();
  const SceneSize size = size_of(spec);
  if (size.rods > most_rods)
    throw SceneError(std::string(size.rods_key) + " is " + std::to_string(size.rods) + "; must be at most " +
                     std::to_string(most_rods) + ", because results number rods in 16 bits; use several scenes");
}

Scene build_scene(const SceneSpec& spec) {
  validate(spec);
  const RodParameters& p = rod_parameters(spec);
  Scene scene;
  scene.gravity_m_s2 = p.gravity_m_s2;
  scene.damping_per_s = p.damping_per_s;
  scene.internal_damping_s = p.internal_damping_s;
  if (p.wind) scene.wind.emplace(*p.wind);
  scene.contact = p.contact;
  scene.obstacles = p.obstacles;
  std::visit([&scene](const auto& rods) { rods.build(scene); }, spec);
  add_prescribed(p.prescribed, scene, p.may_stretch());
  for (Rod& rod : scene.rods)
    for (Joint& joint : rod.joints) joint.is_inextensible = !p.may_stretch();
  return scene;
}

const OpenRod* open_rod(const SceneSpec& spec) {
  if (const auto* rod = std::get_if<BendingRod>(&spec)) return rod;
  return std::get_if<Helix>(&spec);
}

const RodParameters& rod_parameters(const SceneSpec& spec) {
  return std::visit([](const RodParameters& p) -> const RodParameters& { return p; }, spec);
}

SceneSize size_of(const SceneSpec& spec) {
  return std::visit([](const auto& scene) { return scene.size(); }, spec);
}

}  // namespace rodsweep
