// Sixteen floats that the processor handles as one, and the exponential that gates need.
//
// GCC and Clang lower the type to one AVX-512 register, two of AVX or four of SSE.
#pragma once

#include <cstring>

namespace rodsweep {

using Lane16 = float __attribute__((vector_size(64)));
using IntLane16 = int __attribute__((vector_size(64)));

inline Lane16 load16(const float* from) {
  Lane16 out;
  std::memcpy(&out, from, sizeof out);
  return out;
}
inline void store16(float* to, const Lane16& value) { std::memcpy(to, &value, sizeof value); }
inline Lane16 broadcast16(float value) { return Lane16{} + value; }

/// exp(x) for x clamped to [-20, 20], where gates are shut or open to the last bit but one; relative error below 2e-7.
/// x = n ln 2 + r, exp(r) by its Taylor polynomial (|r| <= 0.35), 2^n through the exponent's bits.
inline Lane16 clamped_exp(Lane16 x) {
  x = x > 20.F ? broadcast16(20) : x;
  x = x < -20.F ? broadcast16(-20) : x;
  constexpr float rounding = 12582912;  // 1.5 * 2^23: adding it rounds to an integer
  const Lane16 n = (x * 1.44269504F + rounding) - rounding;
  const Lane16 r = (x - n * 0.693359375F) + n * 2.12194440e-4F;  // ln 2 in two parts
  Lane16 p = broadcast16(1.F / 5040);
  p = p * r + 1.F / 720;
  p = p * r + 1.F / 120;
  p = p * r + 1.F / 24;
  p = p * r + 1.F / 6;
  p = p * r + 0.5F;
  p = p * r + 1.F;
  p = p * r + 1.F;
  const IntLane16 bits = (__builtin_convertvector(n, IntLane16) + 127) << 23;
  Lane16 power;
  std::memcpy(&power, &bits, sizeof power);
  return p * power;
}

}  // namespace rodsweep
