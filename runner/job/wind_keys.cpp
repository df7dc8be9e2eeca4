#include "runner/job/wind_keys.hpp"

namespace rodsweep {

Key wind_key() {
  return object_key(
             "wind", "what the air around the rods does; segments have quadratic drag in it",
             {
                 vector_key("mean_m_s", "mean velocity").in("m/s").at_least(-1e3).at_most(1e3),
                 number_key("gust_strength", "by how much of itself the mean swells and ebbs")
                     .at_least(0)
                     .at_most(10)
                     .defaults_to(0),
                 number_key("gust_period_s", "from one gust to the next").in("s").above(0).at_most(1e6).defaults_to(5),
                 number_key("turbulence_m_s", "root mean square of each component of the turbulence")
                     .in("m/s")
                     .at_least(0)
                     .at_most(1e3)
                     .defaults_to(0),
                 number_key("turbulence_length_m", "distance L of the turbulence's correlation exp(-r^2 / 2 L^2)")
                     .in("m")
                     .above(0)
                     .at_most(1e6)
                     .defaults_to(2),
                 integer_key("turbulence_modes", "waves that make up the turbulence")
                     .at_least(1)
                     .at_most(10000)
                     .defaults_to(16),
                 integer_key("seed", "which turbulence").at_least(0).at_most(1e15).defaults_to(0),
                 number_key("profile_exponent", "p of the mean's growth (height / reference_height_m)^p; 0: none")
                     .at_least(0)
                     .at_most(2)
                     .defaults_to(0),
                 number_key("reference_height_m", "height at which the mean wind is as given")
                     .in("m")
                     .above(0)
                     .at_most(1e6)
                     .defaults_to(10),
                 number_key("air_density_kg_m3", "density of the air")
                     .in("kg/m^3")
                     .at_least(0)
                     .at_most(1e4)
                     .defaults_to(1.2),
                 number_key("drag_coefficient", "of a segment across the flow, by its length times diameter")
                     .at_least(0)
                     .at_most(1e3)
                     .defaults_to(1.2),
                 number_key("friction_coefficient", "of a segment along the flow, by its surface")
                     .at_least(0)
                     .at_most(1e3)
                     .defaults_to(0.01),
             })
      .or_word("none")
      .defaults_to("none");
}

std::optional<WindParameters> wind_parameters(const Point& point) {
  if (!point.has("scene.wind.mean_m_s")) return std::nullopt;
  const auto number = [&point](const char* key) { return point.number(std::string("scene.wind.") + key); };
  const double* mean = point.at("scene.wind.mean_m_s").number;
  WindParameters wind;
  wind.mean_m_s = {mean[0], mean[1], mean[2]};
  wind.gust_strength = number("gust_strength");
  wind.gust_period_s = number("gust_period_s");
  wind.turbulence_m_s = number("turbulence_m_s");
  wind.turbulence_length_m = number("turbulence_length_m");
  wind.turbulence_modes = static_cast<int>(point.integer("scene.wind.turbulence_modes"));
  wind.seed = static_cast<std::uint64_t>(point.integer("scene.wind.seed"));
  wind.profile_exponent = number("profile_exponent");
  wind.reference_height_m = number("reference_height_m");
  wind.air_density_kg_m3 = number("air_density_kg_m3");
  wind.drag_coefficient = number("drag_coefficient");
  wind.friction_coefficient = number("friction_coefficient");
  return wind;
}

}  // namespace rodsweep
