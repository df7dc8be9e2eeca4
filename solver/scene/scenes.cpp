#include "solver/scene/scenes.hpp"

#include <string>

namespace rodsweep {

void validate(const SceneSpec& spec) {
  std::visit([](const auto& scene) { scene.check(); }, spec);
  const RodParameters& p = rod_parameters(spec);
  if (p.stretch == Stretch::physical && p.stretch_compliance_per_j)
    throw SceneError("stretch is physical, but stretch_compliance_per_j is given too; must be one of them");
  if (const auto* tube = p.section ? std::get_if<Tube>(&*p.section) : nullptr)
    require(tube->wall_m <= p.radius_m, "section.wall_m", tube->wall_m, "at most radius_m");
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
  if (p.wind) scene.wind.emplace(*p.wind);
  scene.contact = p.contact;
  scene.obstacles = p.obstacles;
  std::visit([&scene](const auto& rods) { rods.build(scene); }, spec);
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
