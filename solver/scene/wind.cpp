#include "solver/scene/wind.hpp"

#include <algorithm>
#include <cmath>

#include "solver/numbers/counter_random.hpp"
#include "solver/numbers/lane_math.hpp"

namespace rodsweep {

Wind::Wind(const WindParameters& parameters) : p_(parameters) {
  require(p_.mean_m_s.allFinite(), "wind: size of mean_m_s", p_.mean_m_s.norm(), "finite");
  require(p_.gust_period_s > 0, "wind: gust_period_s", p_.gust_period_s, "positive");
  require(p_.turbulence_m_s >= 0, "wind: turbulence_m_s", p_.turbulence_m_s, "at least 0");
  require(p_.turbulence_length_m > 0, "wind: turbulence_length_m", p_.turbulence_length_m, "positive");
  require(p_.turbulence_modes >= 1, "wind: turbulence_modes", p_.turbulence_modes, "at least 1");
  require(p_.reference_height_m > 0, "wind: reference_height_m", p_.reference_height_m, "positive");
  require(p_.air_density_kg_m3 >= 0, "wind: air_density_kg_m3", p_.air_density_kg_m3, "at least 0");
  if (p_.turbulence_m_s == 0) return;
  SplitMix random(p_.seed);
  const double size = p_.turbulence_m_s * std::sqrt(6.0 / p_.turbulence_modes);
  modes_.assign(at((p_.turbulence_modes + lane_width - 1) / lane_width), Modes{});
  for (int m = 0; m < p_.turbulence_modes; ++m) {
    Vector3 wave;
    for (int i = 0; i < 3; ++i) wave[i] = random.normal() / p_.turbulence_length_m;
    const double around = 2 * pi * random.uniform();
    const Vector3 across = wave.unitOrthogonal();
    const Vector3 amplitude = size * (std::cos(around) * across + std::sin(around) * wave.cross(across) / wave.norm());
    const int lane = m % lane_width;
    Modes& modes = modes_[at(m / lane_width)];
    for (int i = 0; i < 3; ++i) {
      modes.amplitude[i][lane] = amplitude[i];
      modes.wave[i][lane] = wave[i] / (2 * pi);
    }
    modes.rate[lane] = (p_.turbulence_m_s * wave.norm() * random.normal() - wave.dot(p_.mean_m_s)) / (2 * pi);
    modes.phase[lane] = random.uniform();
  }
}

Vector3 Wind::velocity(const Vector3& position_m, double time_s) const {
  double mean = 1 + p_.gust_strength * std::sin(2 * pi * time_s / p_.gust_period_s);
  if (p_.profile_exponent != 0)
    mean *= std::pow(std::max(position_m.y(), 0.0) / p_.reference_height_m, p_.profile_exponent);
  Lane turbulence[3] = {};
  for (const Modes& m : modes_) {
    const Lane waves = m.wave[0] * position_m.x() + m.wave[1] * position_m.y() + m.wave[2] * position_m.z();
    const Lane cosine = cosine_of_turns(waves + m.rate * time_s + m.phase);
    for (int i = 0; i < 3; ++i) turbulence[i] += cosine * m.amplitude[i];
  }
  Vector3 out = mean * p_.mean_m_s;
  for (int i = 0; i < 3; ++i)
    for (int lane = 0; lane < lane_width; ++lane) out[i] += turbulence[i][lane];
  return out;
}

Vector3 Wind::drag(const Segment& segment, const Vector3& position_m, const Vector3& direction,
                   const Vector3& velocity_m_s, double time_s, double dt) const {
  const Vector3 past = velocity(position_m, time_s) - velocity_m_s;
  const Vector3 along = direction.dot(past) * direction, across = past - along;
  const double side = p_.air_density_kg_m3 * segment.radius_m * segment.length_m;  // rho d l / 2
  const double most = segment.mass / dt;
  return std::min(side * p_.drag_coefficient * across.norm(), most) * across +
         std::min(side * pi * p_.friction_coefficient * along.norm(), most) * along;
}

}  // namespace rodsweep
