// Owns one file descriptor; empty after a move.
#pragma once

#include <unistd.h>

#include <utility>

namespace rodsweep {

class Descriptor {
 public:
  Descriptor() = default;
  /// `number`: as returned by open(); negative: none.
  explicit Descriptor(int number) : number_(number) {}
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }

  int number() const { return number_; }
  explicit operator bool() const { return number_ >= 0; }

 private:
  int number_ = -1;
};

}  // namespace rodsweep
