// The width of one vector register of the processor that the program is built for.
//
// The solver's six rows fit one 64-byte vector, which the compiler may split (solver/numbers/lanes.hpp). In the
// network's long loops splitting costs too much.
#pragma once

namespace rodsweep {

#if defined(__AVX512F__)
constexpr int lane_bytes = 64;
#elif defined(__AVX__)
constexpr int lane_bytes = 32;
#else
constexpr int lane_bytes = 16;
#endif

}  // namespace rodsweep
