#include "runner/specs/scene_keys.hpp"

#include <string>
#include <tuple>

namespace rodsweep {
namespace {

template <class Solid>
struct SolidKind {
  const char* name;
  const char* help;
  KeyTable<Solid> table;
};

Key place(const char* name, const char* help) { return vector_key(name, help).in("m").from(-1e6, 1e6); }
Key velocity() { return vector_key("velocity_m_s", "constant velocity").in("m/s").from(-1e6, 1e6); }
Key radius() { return number_key("radius_m", "radius").in("m").positive(1e6); }

KeyTable<HalfSpace> half_space_keys() {
  return KeyTable<HalfSpace>()
      .optional(place("point_m", "a point of the plane"), &HalfSpace::point_m)
      .optional(vector_key("normal", "outward direction, of any length").from(-1e6, 1e6), &HalfSpace::normal)
      .optional(velocity(), &HalfSpace::velocity_m_s);
}

KeyTable<Ball> ball_keys() {
  return KeyTable<Ball>()
      .required(place("centre_m", "centre"), &Ball::centre_m)
      .required(radius(), &Ball::radius_m)
      .optional(velocity(), &Ball::velocity_m_s);
}

KeyTable<Capsule> capsule_keys() {
  return KeyTable<Capsule>()
      .required(place("from_m", "one end of the line"), &Capsule::from_m)
      .required(place("to_m", "the other end"), &Capsule::to_m)
      .required(radius(), &Capsule::radius_m)
      .optional(velocity(), &Capsule::velocity_m_s);
}

const auto& solid_kinds() {
  static const std::tuple kinds{
      SolidKind<HalfSpace>{"half_space", "everything below a plane", half_space_keys()},
      SolidKind<Ball>{"ball", "a ball", ball_keys()},
      SolidKind<Capsule>{"capsule", "everything within a radius of a line between two points", capsule_keys()}};
  return kinds;
}

template <class Solid>
void read_if(const SolidKind<Solid>& kind, const KeyValue& at, Obstacle& obstacle) {
  if (at.text() != kind.name) return;
  Solid solid;
  kind.table.fill(solid, at.of(kind.name));
  obstacle = solid;
}

Obstacle obstacle(const KeyValue& at) {
  Obstacle found;
  std::apply([&](const auto&... kind) { (read_if(kind, at, found), ...); }, solid_kinds());
  if (const auto* space = std::get_if<HalfSpace>(&found); space && space->normal.isZero(0))
    throw job_error(at.job().path, at.path() + ".half_space.normal", "[0, 0, 0] is not allowed; must have a direction");
  return found;
}

/// The keys of `schedule`. `help`: what is multiplied.
template <class Owner>
void add_schedule(KeyTable<Owner>& table, const char* what) {
  table.optional(list_key("times_s", "times, increasing, at which factors are given; none: constant",
                          number_key("time", "time").in("s").from(-1e9, 1e9))
                     .in("s"),
                 [](Owner& of) -> std::vector<double>& { return of.schedule.times_s; });
  table.optional(list_key("factors", what, number_key("factor", "factor").from(-1e9, 1e9)),
                 [](Owner& of) -> std::vector<double>& { return of.schedule.factors; });
  table.optional(boolean_key("smooth", "between times: linear, or smooth with zero speed at each of them"),
                 [](Owner& of) -> bool& { return of.schedule.smooth; });
}

const KeyTable<PrescribedLoad>& load_keys() {
  static const auto keys = [] {
    KeyTable<PrescribedLoad> table;
    table.required(place("at_m", "point of a rod at the start"), &PrescribedLoad::at_m);
    table.optional(vector_key("force_n", "force, fixed in the world").in("N").from(-1e12, 1e12),
                   &PrescribedLoad::force_n);
    table.optional(vector_key("torque_nm", "torque, fixed in the world").in("N m").from(-1e12, 1e12),
                   &PrescribedLoad::torque_nm);
    add_schedule(table, "factors of force and torque at these times, linear between them, constant before and after");
    return table;
  }();
  return keys;
}

const KeyTable<PrescribedMotion>& motion_keys() {
  static const auto keys = [] {
    KeyTable<PrescribedMotion> table;
    table.required(place("at_m", "point of a held segment at the start, about which it turns"),
                   &PrescribedMotion::at_m);
    table.optional(vector_key("displacement_m", "from its initial place").in("m").from(-1e6, 1e6),
                   &PrescribedMotion::displacement_m);
    table.optional(
        vector_key("rotation_deg", "rotation vector, in the world: the axis times the angle").in("deg").from(-1e6, 1e6),
        &PrescribedMotion::rotation_deg);
    add_schedule(table, "factors of displacement and rotation at these times; the motion starts with 0");
    return table;
  }();
  return keys;
}

const KeyTable<GravityChange>& gravity_keys() {
  static const auto keys = [] {
    KeyTable<GravityChange> table;
    table.required(vector_key("by_m_s2", "is added to gravity_m_s2").in("m/s^2").from(-1e6, 1e6),
                   &GravityChange::by_m_s2);
    add_schedule(table, "factors of by_m_s2 at these times, linear between them, constant before and after");
    return table;
  }();
  return keys;
}

template <class Item>
void read_list(const KeyTable<Item>& keys, const KeyValue& list, std::vector<Item>& items) {
  items.clear();
  const std::string& first = keys.keys().front().name;
  while (list.item(items.size()).of(first).is_given()) {
    const KeyValue item = list.item(items.size());
    keys.fill(items.emplace_back(), item);
  }
}

}  // namespace

KeyTable<SectionShape> section_keys() {
  using Given = GivenSection;
  const auto length = [](const char* name, const char* help) {
    return number_key(name, help).in("m").positive(1e3).plausibly(1e-6, 10);
  };
  const auto moment = [](const char* name, const char* help) {
    return number_key(name, help).in("m^4").positive(1e12);
  };
  const auto width_m = [](auto& of) -> decltype((of.width_m)) { return of.width_m; };
  const auto height_m = [](auto& of) -> decltype((of.height_m)) { return of.height_m; };
  KeyTable<SectionShape> table;
  Key type = choice_key("type", "shape of the cross-section")
                 .unswept(
                     "to sweep over sections, list complete ones: \"section\": {\"grid\": [\"circle\", {\"type\": "
                     "\"tube\", ...}]}");
  KindsOf<SectionShape>::each([&](const auto& shape) { type.choices.emplace_back(shape.name); });
  table.unbound(type);
  table.required(length("wall_m", "thickness of the wall of a tube with the outer radius radius_m"), &Tube::wall_m);
  table.required(length("width_m", "across the height"), width_m);
  table.required(length("height_m", "upwards in a bending rod, outwards in a helix or a ring"), height_m);
  table.required(number_key("area_m2", "area A").in("m^2").positive(1e6), &Given::area_m2);
  table.required(moment("second_moment_height_m4", "integral of the squared height over the area: for bending upwards"),
                 &Given::second_moment_height_m4);
  table.required(moment("second_moment_width_m4", "integral of the squared width over the area: for bending sideways"),
                 &Given::second_moment_width_m4);
  table.required(moment("torsion_constant_m4", "J of the torsional stiffness G J"), &Given::torsion_constant_m4);
  table.optional(number_key("shear_coefficient", "kappa of the shear stiffness kappa G A").positive(1),
                 &Given::shear_coefficient);
  return table;
}

KeyTable<TipMotion> tip_motion_keys() {
  return KeyTable<TipMotion>()
      .required(number_key("duration_s", "time of the motion, from the start").in("s").positive(1e6),
                &TipMotion::duration_s)
      .optional(vector_key("displacement_m", "from the initial place of the end").in("m").from(-1e6, 1e6),
                &TipMotion::displacement_m)
      .optional(vector_key("rotation_deg", "rotation vector, in the world: the axis times the angle")
                    .in("deg")
                    .from(-1e6, 1e6),
                &TipMotion::rotation_deg);
}

KeyTable<WindParameters> wind_keys() {
  using Air = WindParameters;
  return KeyTable<Air>()
      .required(vector_key("mean_m_s", "mean velocity")
                    .in("m/s")
                    .from(-1e3, 1e3)
                    .plausibly(0, 120, "a hurricane has 33 and more"),
                &Air::mean_m_s)
      .optional(number_key("gust_strength", "strength of gusts, relative to the mean velocity").from(0, 10),
                &Air::gust_strength)
      .optional(number_key("gust_period_s", "period of the gusts").in("s").positive(1e6), &Air::gust_period_s)
      .optional(
          number_key("turbulence_m_s", "root mean square of each component of the turbulence").in("m/s").from(0, 1e3),
          &Air::turbulence_m_s)
      .optional(number_key("turbulence_length_m", "distance L of the turbulence's correlation exp(-r^2 / 2 L^2)")
                    .in("m")
                    .positive(1e6),
                &Air::turbulence_length_m)
      .optional(integer_key("turbulence_modes", "number of waves in the turbulence").from(1, 10000),
                &Air::turbulence_modes)
      .optional(integer_key("seed", "seed of the turbulence").from(0, 1e15), &Air::seed)
      .optional(number_key("profile_exponent", "p of the mean profile (height / reference_height_m)^p; 0: uniform")
                    .from(0, 2),
                &Air::profile_exponent)
      .optional(number_key("reference_height_m", "height at which mean_m_s applies").in("m").positive(1e6),
                &Air::reference_height_m)
      .optional(number_key("air_density_kg_m3", "density of the air").in("kg/m^3").from(0, 1e4),
                &Air::air_density_kg_m3)
      .optional(
          number_key("drag_coefficient", "for flow across a segment, based on length times diameter").from(0, 1e3),
          &Air::drag_coefficient)
      .optional(number_key("friction_coefficient", "for flow along a segment, based on its surface").from(0, 1e3),
                &Air::friction_coefficient);
}

KeyTable<ContactSettings> contact_keys() {
  using Settings = ContactSettings;
  return KeyTable<Settings>()
      .optional(number_key("friction", "Coulomb friction coefficient, static and sliding").from(0, 100),
                &Settings::friction)
      .optional(number_key("obstacle_friction",
                           "friction coefficient of rods with obstacles and the floor; \"friction\": the same")
                    .from(0, 100)
                    .or_word("friction"),
                &Settings::obstacle_friction)
      .optional(number_key("restitution",
                           "coefficient of restitution: speed of separation after an impact, over that of the approach")
                    .from(0, 1),
                &Settings::restitution)
      .optional(number_key("tolerance",
                           "contacts have converged if no correction of a segment is larger than this, in its radii; "
                           "\"from_step\" is 0.02 / s times step_s")
                    .positive(1)
                    .or_word("from_step"),
                &Settings::tolerance)
      .optional(
          integer_key("sweeps",
                      "maximum number of contact sweeps, over all contacts and back, after a projection of the rods")
              .from(1, 10000),
          &Settings::sweeps)
      .optional(number_key("recovery",
                           "fraction of a penetration from earlier steps that a step removes, at most 1 % of a radius")
                    .from(0, 1),
                &Settings::recovery);
}

Key obstacles_key() {
  const auto keys = [](const auto&... kind) {
    return std::vector<Key>{object_key(kind.name, kind.help, kind.table.keys())...};
  };
  return list_key(
      "obstacles", "solids that rods with \"contact\" touch, besides each other and the floor of the scene",
      variant_key("obstacle", "a solid at rest or with constant velocity", std::apply(keys, solid_kinds())));
}

Key loads_key() {
  return list_key("loads", "forces and torques at points of rods",
                  object_key("load", "a force and a torque at a point", load_keys().keys()));
}

Key motions_key() {
  return list_key("motions", "motions of clamps",
                  object_key("motion", "a motion of a held segment", motion_keys().keys()));
}

Key gravity_changes_key() {
  return list_key("gravity_changes", "what is added to gravity over time",
                  object_key("change", "a change of gravity", gravity_keys().keys()));
}

void read_value(const KeyValue& list, std::vector<double>& numbers) {
  numbers.clear();
  while (list.item(numbers.size()).is_given()) numbers.push_back(list.item(numbers.size()).number());
}

void read_value(const KeyValue& list, std::vector<Vector3>& points) {
  points.clear();
  while (list.item(points.size()).is_given())
    points.emplace_back(Vector3::Map(list.item(points.size()).value().number));
}

void read_value(const KeyValue& list, std::vector<PrescribedLoad>& loads) { read_list(load_keys(), list, loads); }
void read_value(const KeyValue& list, std::vector<PrescribedMotion>& motions) {
  read_list(motion_keys(), list, motions);
}
void read_value(const KeyValue& list, std::vector<GravityChange>& changes) { read_list(gravity_keys(), list, changes); }

void read_value(const KeyValue& list, std::vector<Obstacle>& obstacles) {
  obstacles.clear();
  while (true) {
    const KeyValue item = list.item(obstacles.size());
    if (!item.is_given()) return;
    obstacles.push_back(obstacle(item));
  }
}

}  // namespace rodsweep
