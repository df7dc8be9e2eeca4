// Transposes vectors and quaternions between memory (record after record) and lanes (one record per lane): as many
// records as a register has lanes, or fewer at the end of an array.
#pragma once

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include "solver/numbers/lane_math.hpp"

namespace rodsweep {

/// Registers and lanes of a run of records of three or four entries: entry `e` of the run is entry e % size of record
/// e / size. A shuffle numbers the lanes of its first operand first, so W = lane_width marks the second.
namespace lane_records {

inline constexpr int W = lane_width;
using Indices = std::make_integer_sequence<int, W>;

/// Component c of W records of three, which fill v.
template <int c, int... lane>
inline Lane component(const Lane (&v)[3], std::integer_sequence<int, lane...>) {
  const Lane pair = __builtin_shufflevector(v[0], v[1], (3 * lane + c < 2 * W ? 3 * lane + c : 0)...);
  return __builtin_shufflevector(pair, v[2], (3 * lane + c < 2 * W ? lane : 3 * lane + c - W)...);
}

/// Of records of four: each pair of registers has half of them.
template <int c, int... lane>
inline Lane component(const Lane (&v)[4], std::integer_sequence<int, lane...>) {
  const Lane low = __builtin_shufflevector(v[0], v[1], (4 * lane + c) % (2 * W)...);
  const Lane high = __builtin_shufflevector(v[2], v[3], (4 * lane + c) % (2 * W)...);
  return __builtin_shufflevector(low, high, (lane < W / 2 ? lane : W + lane)...);
}

/// Register r of W records of three with the components v.
template <int r, int... i>
inline Lane part(const Lane (&v)[3], std::integer_sequence<int, i...>) {
  const Lane pair = __builtin_shufflevector(v[0], v[1], (r * W + i) / 3 + ((r * W + i) % 3 == 1 ? W : 0)...);
  return __builtin_shufflevector(pair, v[2], ((r * W + i) % 3 == 2 ? W + (r * W + i) / 3 : i)...);
}

template <int r, int... i>
inline Lane part(const Lane (&v)[4], std::integer_sequence<int, i...>) {
  const Lane low = __builtin_shufflevector(v[0], v[1], (r * W + i) / 4 + i % 2 * W...);
  const Lane high = __builtin_shufflevector(v[2], v[3], (r * W + i) / 4 + i % 2 * W...);
  return __builtin_shufflevector(low, high, ((r * W + i) % 4 < 2 ? i : W + i)...);
}

template <int size>
using Registers = std::array<Lane, size>;

/// The components of as many records of `size` entries as a register has lanes, of at most `count`: surplus lanes
/// repeat the last record.
template <int size, class Record, int... c>
inline Registers<size> components(const Record* from, int count, std::integer_sequence<int, c...>) {
  Record copies[W];
  if (count < W) {
    for (int i = 0; i < W; ++i) copies[i] = from[std::min(i, count - 1)];
    from = copies;
  }
  Lane v[size];
  std::memcpy(v, from, sizeof v);
  return {component<c>(v, Indices())...};
}
template <int size, class Record>
inline Registers<size> components(const Record* from, int count) {
  return components<size>(from, count, std::make_integer_sequence<int, size>());
}

/// The registers that the records with these components fill.
template <int size, int... r>
inline Registers<size> run(const Lane (&v)[size], std::integer_sequence<int, r...>) {
  return {part<r>(v, Indices())...};
}
template <int size>
inline Registers<size> run(const Lane (&v)[size]) {
  return run(v, std::make_integer_sequence<int, size>());
}

template <int size, class Record>
inline void store(const Lane (&v)[size], Record* to, int count) {
  const Registers<size> records = run(v);
  std::memcpy(reinterpret_cast<double*>(to), &records, at(std::min(count, W)) * size * sizeof(double));
}

}  // namespace lane_records

/// The first of `count` vectors, one in each lane; surplus lanes repeat the last.
inline LaneVector load(const Vector3* from, int count) {
  const auto [x, y, z] = lane_records::components<3>(from, count);
  return {x, y, z};
}
inline LaneQuaternion load(const Quaternion* from, int count) {
  const auto [x, y, z, w] = lane_records::components<4>(from, count);
  return {w, x, y, z};
}

/// Stores at most `count` records.
inline void store(const LaneVector& v, Vector3* to, int count) { lane_records::store({v.x, v.y, v.z}, to, count); }
inline void store(const LaneQuaternion& q, Quaternion* to, int count) {
  lane_records::store({q.x, q.y, q.z, q.w}, to, count);
}

/// Stores all records of four, `stride` doubles apart. `Register` is Lane.
template <class Register>
inline void scatter(const Register (&v)[4], double* to, std::ptrdiff_t stride) {
  const auto records = lane_records::run(v);
#pragma GCC unroll 4
  for (int r = 0; r < 4; ++r) {
    const Register& here = records[r];
    const std::ptrdiff_t first = r * lane_width;
    if constexpr (sizeof(Register) == 2 * sizeof(Lane4)) {
      const Lane4 even = __builtin_shufflevector(here, here, 0, 1, 2, 3);
      const Lane4 odd = __builtin_shufflevector(here, here, 4, 5, 6, 7);
      std::memcpy(to + first / 4 * stride, &even, sizeof even);
      std::memcpy(to + (first / 4 + 1) * stride, &odd, sizeof odd);
    } else {
      std::memcpy(to + first / 4 * stride + first % 4, &here, sizeof here);
    }
  }
}

}  // namespace rodsweep
