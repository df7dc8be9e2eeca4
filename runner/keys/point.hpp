// A parameter point of a job: what its keys are filled from.
#pragma once

#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

namespace rodsweep {

/// The values of parameters at one point of a sweep. References the SweepSpace that filled it.
class Point {
 public:
  using Index = std::unordered_map<std::string, int>;  ///< of parameters, by path
  bool has(const std::string& path) const;
  double number(const std::string& path) const;
  std::int64_t integer(const std::string& path) const;
  const std::string& text(const std::string& path) const;

  struct Value {
    enum class State : std::uint8_t { absent, number, text };
    State state = State::absent;
    double number[3] = {0, 0, 0};  ///< also integers, which are below 2^53; a boolean: 0 or 1
    const std::string* text = nullptr;

    bool is_text() const { return state == State::text; }  ///< also if a number key has a word
  };
  const Value& operator[](std::size_t parameter) const { return values_[parameter]; }
  const Value* find(const std::string& path) const;  ///< nullptr if absent
  const Value& at(const std::string& path) const;    ///< throws std::logic_error if absent
  void set(std::size_t parameter, double value);

 private:
  friend class SweepSpace;
  const Index* index_ = nullptr;
  std::vector<Value> values_;
};

}  // namespace rodsweep
