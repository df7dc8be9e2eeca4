// A parameter point of a job: what its keys are filled from.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <vector>

namespace rodsweep {

/// The values of parameters at one point of a sweep. References the SweepSpace that filled it.
class Point {
 public:
  using Index = std::unordered_map<std::string, int>;  ///< of parameters, by path

  struct Value {
    enum class State : std::uint8_t { absent, number, text };
    State state = State::absent;
    double number[3] = {0, 0, 0};  ///< also integers, which are below 2^53; a boolean: 0 or 1
    const std::string* text = nullptr;

    bool is_text() const { return state == State::text; }  ///< also if a number key has a word
  };
  const Value& operator[](std::size_t parameter) const { return values_[parameter]; }
  /// Null if absent.
  const Value* find(const std::string& path) const {
    const auto known = index_->find(path);
    if (known == index_->end()) return nullptr;
    const Value& value = values_[static_cast<std::size_t>(known->second)];
    return value.state == Value::State::absent ? nullptr : &value;
  }
  bool has(const std::string& path) const { return find(path) != nullptr; }

  // These throw std::logic_error if the path has no value of this type.
  const Value& at(const std::string& path) const {
    if (const Value* found = find(path)) return *found;
    throw std::logic_error(fmt::format("the job has no value for {} at this point", path));
  }
  double number(const std::string& path) const { return at(path).number[0]; }
  const std::string& text(const std::string& path) const {
    if (const Value& value = at(path); value.is_text()) return *value.text;
    throw std::logic_error(fmt::format("{} is not a text", path));
  }

 private:
  friend class SweepSpace;
  const Index* index_ = nullptr;
  std::vector<Value> values_;
};

}  // namespace rodsweep
