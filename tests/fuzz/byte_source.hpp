// Decisions out of a fuzzer's input, in order: numbers, words, yes or no; nothing but zeros once it is used up. As
// libFuzzer's FuzzedDataProvider, which GCC does not have.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>

namespace rodsweep::fuzz {

class ByteSource {
 public:
  ByteSource(const std::uint8_t* bytes, std::size_t size) : at_(bytes), left_(size) {}

  std::size_t left() const { return left_; }

  template <class Integer>
  Integer value() {
    Integer number = 0;
    const std::size_t taken = std::min(sizeof number, left_);
    if (taken > 0) std::memcpy(&number, at_, taken);
    at_ += taken;
    left_ -= taken;
    return number;
  }

  /// From `least` to `most`, both included: by one byte where it can tell so many numbers apart, else by four.
  template <class Integer>
  Integer in_range(Integer least, Integer most) {
    const auto numbers = static_cast<std::uint64_t>(most - least) + 1;
    const std::uint64_t drawn = numbers <= 256 ? value<std::uint8_t>() : value<std::uint32_t>();
    return static_cast<Integer>(least + static_cast<Integer>(drawn % numbers));
  }

  bool flag() { return (value<std::uint8_t>() & 1) != 0; }

  std::string text(std::size_t most) {
    std::string word(std::min(in_range<std::size_t>(0, most), left_), '\0');
    for (char& letter : word) letter = value<char>();
    return word;
  }

 private:
  const std::uint8_t* at_;
  std::size_t left_;
};

}  // namespace rodsweep::fuzz
