#include "runner/keys/point.hpp"

#include <fmt/format.h>

#include <stdexcept>

namespace rodsweep {

const Point::Value* Point::find(const std::string& path) const {
  const auto known = index_->find(path);
  if (known == index_->end()) return nullptr;
  const Value& value = values_[static_cast<std::size_t>(known->second)];
  return value.state == Value::State::absent ? nullptr : &value;
}

bool Point::has(const std::string& path) const { return find(path) != nullptr; }

const Point::Value& Point::at(const std::string& path) const {
  const Value* found = find(path);
  if (found == nullptr) throw std::logic_error(fmt::format("the job has no value for {} at this point", path));
  return *found;
}

double Point::number(const std::string& path) const { return at(path).number[0]; }
std::int64_t Point::integer(const std::string& path) const { return static_cast<std::int64_t>(at(path).number[0]); }

const std::string& Point::text(const std::string& path) const {
  const Value& value = at(path);
  if (!value.is_text()) throw std::logic_error(fmt::format("{} is not a text", path));
  return *value.text;
}

void Point::set(std::size_t parameter, double value) {
  values_[parameter].state = Value::State::number;
  values_[parameter].number[0] = value;
}

}  // namespace rodsweep
