// A 64-bit checksum of a task's data: FNV-1a (Fowler, Noll, Vo) on eight bytes at a time, which is cheap compared with
// writing. Multiplication by an odd constant and exclusive or are bijective, so any single changed word changes the
// sum.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace rodsweep {

class Checksum {
 public:
  void add(const void* data, std::size_t bytes) {
    const auto* p = static_cast<const unsigned char*>(data);
    mix(bytes);  // detects moved block boundaries
    for (; bytes >= sizeof(std::uint64_t); p += sizeof(std::uint64_t), bytes -= sizeof(std::uint64_t))
      mix(word(p, sizeof(std::uint64_t)));
    if (bytes > 0) mix(word(p, bytes));
  }

  std::uint64_t value() const { return value_; }

 private:
  static std::uint64_t word(const unsigned char* p, std::size_t bytes) {
    std::uint64_t w = 0;
    std::memcpy(&w, p, bytes);
    return w;
  }
  void mix(std::uint64_t w) { value_ = (value_ ^ w) * 0x100000001b3ull; }

  std::uint64_t value_ = 0xcbf29ce484222325ull;
};

}  // namespace rodsweep
