#include "runner/job/contact_keys.hpp"

namespace rodsweep {

KeyTable<ContactSettings> contact_keys() {
  using Settings = ContactSettings;
  KeyTable<Settings> table;
  table.optional(number_key("friction", "Coulomb's coefficient, at rest and sliding").from(0, 100),
                 &Settings::friction);
  table.optional(
      number_key("tolerance", "contacts have converged where none wants to move a segment by more, in its radii")
          .above(0)
          .at_most(1),
      &Settings::tolerance);
  table.optional(integer_key("sweeps", "over all contacts after a projection of the rods, at most").from(1, 10000),
                 &Settings::sweeps);
  table.optional(number_key("recovery",
                            "share of a penetration, left by earlier steps, that a step takes back, within 1 % of a "
                            "radius")
                     .from(0, 1),
                 &Settings::recovery);
  return table;
}

}  // namespace rodsweep
