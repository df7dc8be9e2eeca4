// A vector of as many floats as the processor handles in one instruction.
#pragma once

#include <cstring>

#include "network/layers/native_lanes.hpp"

namespace rodsweep {

constexpr int lane_floats = lane_bytes / static_cast<int>(sizeof(float));
using FloatLane = float __attribute__((vector_size(lane_bytes)));

inline FloatLane load_lane(const float* from) {
  FloatLane out;
  std::memcpy(&out, from, sizeof out);
  return out;
}
inline void store_lane(float* to, const FloatLane& value) { std::memcpy(to, &value, sizeof value); }
inline FloatLane broadcast_lane(float value) { return FloatLane{} + value; }

}  // namespace rodsweep
