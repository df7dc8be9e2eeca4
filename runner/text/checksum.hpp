// A 64-bit checksum of a task's data: FNV-1a (Fowler, Noll, Vo) taken eight bytes at a time, so that it costs little
// beside writing. Multiplication by an odd constant and exclusive or are one-to-one: any single changed word changes
// the sum.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace rodsweep {

class Checksum {
 public:
  void add(const void* data, std::size_t bytes) {
    const auto* p = static_cast<const unsigned char*>(data);
    mix(bytes);  // so that a block boundary cannot move unnoticed
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
