#include "solver/scene/schedule.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "solver/rod/rod.hpp"

namespace rodsweep {

double Schedule::at(double time_s) const {
  if (times_s.empty()) return 1;
  const auto next = std::upper_bound(times_s.begin(), times_s.end(), time_s);
  if (next == times_s.begin()) return factors.front();
  if (next == times_s.end()) return factors.back();
  const auto i = static_cast<std::size_t>(next - times_s.begin());
  const double u = (time_s - times_s[i - 1]) / (times_s[i] - times_s[i - 1]);
  const double done = smooth ? u * u * u * (10 - 15 * u + 6 * u * u) : u;
  return factors[i - 1] + done * (factors[i] - factors[i - 1]);
}

double Schedule::largest() const {
  double most = factors.empty() ? 1 : 0;
  for (const double factor : factors) most = std::max(most, std::abs(factor));
  return most;
}

void Schedule::check() const {
  if (times_s.size() != factors.size())
    throw SceneError("times_s has " + std::to_string(times_s.size()) + " values, factors " +
                     std::to_string(factors.size()) + "; must be as many");
  for (std::size_t i = 1; i < times_s.size(); ++i)
    require(times_s[i] > times_s[i - 1], "a value of times_s", times_s[i], "greater than the one before");
}

}  // namespace rodsweep
