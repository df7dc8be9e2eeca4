// As many floats as the processor handles as one, and the exponential that gates need.
#pragma once

#include <cstring>

#include "network/layers/native_lanes.hpp"

namespace rodsweep {

constexpr int lane_floats = lane_bytes / static_cast<int>(sizeof(float));
using FloatLane = float __attribute__((vector_size(lane_bytes)));
using IntLane = int __attribute__((vector_size(lane_bytes)));

inline FloatLane load_lane(const float* from) {
  FloatLane out;
  std::memcpy(&out, from, sizeof out);
  return out;
}
inline void store_lane(float* to, const FloatLane& value) { std::memcpy(to, &value, sizeof value); }
inline FloatLane broadcast_lane(float value) { return FloatLane{} + value; }

/// exp(x) for x clamped to [-20, 20], where gates are shut or open to the last bit but one; relative error below 3e-7.
/// x = n ln 2 + r, exp(r) by its Taylor polynomial (|r| <= 0.35), 2^n through the exponent's bits.
inline FloatLane clamped_exp(FloatLane x) {
  x = x > 20.F ? broadcast_lane(20) : x;
  x = x < -20.F ? broadcast_lane(-20) : x;
  constexpr float rounding = 12582912;  // 1.5 * 2^23: adding it rounds to an integer
  const FloatLane n = (x * 1.44269504F + rounding) - rounding;
  const FloatLane r = (x - n * 0.693359375F) + n * 2.12194440e-4F;  // ln 2 in two parts
  FloatLane p = broadcast_lane(1.F / 5040);
  p = p * r + 1.F / 720;
  p = p * r + 1.F / 120;
  p = p * r + 1.F / 24;
  p = p * r + 1.F / 6;
  p = p * r + 0.5F;
  p = p * r + 1.F;
  p = p * r + 1.F;
  const IntLane bits = (__builtin_convertvector(n, IntLane) + 127) << 23;
  FloatLane power;
  std::memcpy(&power, &bits, sizeof power);
  return p * power;
}

}  // namespace rodsweep
