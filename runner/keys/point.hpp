// A parameter point of a job: what its keys are filled from.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <utility>
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
  friend class ObjectPoint;
  const Index* index_ = nullptr;
  std::vector<Value> values_;
};

/// The values of an object without sweeps, such as the settings of a training.
class ObjectPoint {
 public:
  explicit ObjectPoint(const nlohmann::ordered_json& object) : values_(object.flatten()) {
    point_.index_ = &index_;
    for (const auto& [pointer, value] : values_.items()) {  // "/network/steps"
      std::string path = pointer.substr(std::min<std::size_t>(pointer.size(), 1));
      std::replace(path.begin(), path.end(), '/', '.');
      index_.emplace(std::move(path), static_cast<int>(point_.values_.size()));
      Point::Value& added = point_.values_.emplace_back();
      using State = Point::Value::State;
      added.state = value.is_null() ? State::absent : value.is_string() ? State::text : State::number;
      if (value.is_string()) added.text = &value.get_ref<const std::string&>();
      if (value.is_number()) added.number[0] = value.get<double>();
      if (value.is_boolean()) added.number[0] = value.get<bool>() ? 1 : 0;
    }
  }
  ObjectPoint(const ObjectPoint&) = delete;
  ObjectPoint& operator=(const ObjectPoint&) = delete;

  operator const Point&() const { return point_; }

 private:
  nlohmann::ordered_json values_;
  Point::Index index_;
  Point point_;
};

}  // namespace rodsweep
