#include "runner/job/contact_keys.hpp"

namespace rodsweep {
namespace {

template <class Spec>
Spec rods_of(const Point& point) {
  Spec spec;
  spec.segments = static_cast<int>(point.integer("scene.segments"));
  spec.length_m = point.number("scene.length_m");
  return spec;
}

}  // namespace

std::vector<Key> contact_keys() {
  return {
      object_key(
          "contact", "rods touch each other, themselves and the floor, without rebound",
          {
              number_key("friction", "Coulomb's coefficient, at rest and sliding")
                  .at_least(0)
                  .at_most(100)
                  .defaults_to(0.3),
              number_key("tolerance",
                         "contacts have converged where none wants to move a segment by more, in its radii")
                  .above(0)
                  .at_most(1)
                  .defaults_to(1e-5),
              integer_key("sweeps", "over all contacts after a projection of the rods, at most")
                  .at_least(1)
                  .at_most(10000)
                  .defaults_to(100),
              number_key(
                  "recovery",
                  "share of a penetration, left by earlier steps, that a step takes back, within 1 % of a radius")
                  .at_least(0)
                  .at_most(1)
                  .defaults_to(0.2),
          })
          .or_word("none")
          .defaults_to("none"),
      integer_key("rods", "number of rods").at_least(1).at_most(30000).only({"falling_rods", "bundle"}),
      integer_key("rings", "number of rings of a chain").at_least(1).at_most(30000).only({"ring_chain"}),
      number_key("height_m", "from one falling rod to the next and to the floor; of a coiling rod's end above it")
          .in("m")
          .above(0)
          .at_most(1e6)
          .only({"falling_rods", "coiling_rod"}),
      number_key("turn_deg", "of each falling rod against the one below")
          .in("deg")
          .at_least(-360)
          .at_most(360)
          .defaults_to(50)
          .only({"falling_rods"}),
      number_key("feed_m_s", "how fast the held end of a coiling rod goes down")
          .in("m/s")
          .at_least(0)
          .at_most(1e3)
          .only({"coiling_rod"}),
      number_key("pull_m_s", "how fast each end of a knot is pulled away")
          .in("m/s")
          .at_least(0)
          .at_most(1e3)
          .only({"knot"}),
  };
}

std::optional<ContactSettings> contact_settings(const Point& point) {
  if (!point.has("scene.contact.friction")) return std::nullopt;
  ContactSettings contact;
  contact.friction = point.number("scene.contact.friction");
  contact.tolerance = point.number("scene.contact.tolerance");
  contact.sweeps = static_cast<int>(point.integer("scene.contact.sweeps"));
  contact.recovery = point.number("scene.contact.recovery");
  return contact;
}

FallingRods falling_rods(const Point& point) {
  FallingRods rods = rods_of<FallingRods>(point);
  rods.rods = static_cast<int>(point.integer("scene.rods"));
  rods.height_m = point.number("scene.height_m");
  rods.turn_deg = point.number("scene.turn_deg");
  return rods;
}

CoilingRod coiling_rod(const Point& point) {
  CoilingRod rod = rods_of<CoilingRod>(point);
  rod.height_m = point.number("scene.height_m");
  rod.feed_m_s = point.number("scene.feed_m_s");
  return rod;
}

Knot knot(const Point& point) {
  Knot rod = rods_of<Knot>(point);
  rod.pull_m_s = point.number("scene.pull_m_s");
  return rod;
}

RingChain ring_chain(const Point& point) {
  RingChain rings = rods_of<RingChain>(point);
  rings.rings = static_cast<int>(point.integer("scene.rings"));
  return rings;
}

Bundle bundle(const Point& point) {
  Bundle rods = rods_of<Bundle>(point);
  rods.rods = static_cast<int>(point.integer("scene.rods"));
  rods.initial_angle_deg = point.number("scene.initial_angle_deg");
  return rods;
}

}  // namespace rodsweep
