#include "runner/job/wind_keys.hpp"

namespace rodsweep {

KeyTable<WindParameters> wind_keys() {
  using Air = WindParameters;
  KeyTable<Air> table;
  table.required(vector_key("mean_m_s", "mean velocity").in("m/s").from(-1e3, 1e3), &Air::mean_m_s);
  table.optional(number_key("gust_strength", "by how much of itself the mean swells and ebbs").from(0, 10),
                 &Air::gust_strength);
  table.optional(number_key("gust_period_s", "from one gust to the next").in("s").above(0).at_most(1e6),
                 &Air::gust_period_s);
  table.optional(
      number_key("turbulence_m_s", "root mean square of each component of the turbulence").in("m/s").from(0, 1e3),
      &Air::turbulence_m_s);
  table.optional(number_key("turbulence_length_m", "distance L of the turbulence's correlation exp(-r^2 / 2 L^2)")
                     .in("m")
                     .above(0)
                     .at_most(1e6),
                 &Air::turbulence_length_m);
  table.optional(integer_key("turbulence_modes", "waves that make up the turbulence").from(1, 10000),
                 &Air::turbulence_modes);
  table.optional(integer_key("seed", "which turbulence").from(0, 1e15), &Air::seed);
  table.optional(
      number_key("profile_exponent", "p of the mean's growth (height / reference_height_m)^p; 0: none").from(0, 2),
      &Air::profile_exponent);
  table.optional(
      number_key("reference_height_m", "height at which the mean wind is as given").in("m").above(0).at_most(1e6),
      &Air::reference_height_m);
  table.optional(number_key("air_density_kg_m3", "density of the air").in("kg/m^3").from(0, 1e4),
                 &Air::air_density_kg_m3);
  table.optional(
      number_key("drag_coefficient", "of a segment across the flow, by its length times diameter").from(0, 1e3),
      &Air::drag_coefficient);
  table.optional(number_key("friction_coefficient", "of a segment along the flow, by its surface").from(0, 1e3),
                 &Air::friction_coefficient);
  return table;
}

}  // namespace rodsweep
