#include "runner/sweep/sweep_space.hpp"

#include <algorithm>
#include <cmath>

#include "runner/keys/sweep_words.hpp"
#include "runner/text/job_error.hpp"
#include "solver/numbers/counter_random.hpp"

namespace rodsweep {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::int64_t most_points = 1000000000000000;  // counts saturate here, far above any sweep

std::int64_t saturated(double value) {
  return value >= static_cast<double>(most_points) ? most_points : static_cast<std::int64_t>(value);
}

}  // namespace

SweepSpace::SweepSpace(const Json& values, const std::filesystem::path& file)
    : file_(file), seed_(values["seed"]), is_even_(values["sampling"] == "sobol") {
  read(job_key(), values, "", 0, root_);
  count(root_);
}

int SweepSpace::find(const std::string& path) const {
  const auto found = index_.find(path);
  return found == index_.end() ? -1 : found->second;
}

int SweepSpace::parameter(const std::string& path, const Key& key) {
  const auto [place, is_new] = index_.emplace(path, static_cast<int>(parameters_.size()));
  if (is_new) parameters_.push_back({path, key});
  return place->second;
}

void SweepSpace::read(const Key& key, const Json& value, const std::string& path, int component, Scope& scope) {
  if (!sweep_word(value).empty()) return read_sweep(key, value, path, component, scope);
  if (has_option_label(key)) scope.fixed.push_back({parameter(path, key), 0, option_label(key, value)});
  switch (key.kind) {
    case Key::Kind::object:
    case Key::Kind::variant:
      if (value.is_string()) return;  // none of its keys
      for (const auto& [name, child] : value.items()) {
        const Key& child_key = *find_key(key.keys, name);
        if (child_key.parameter) read(child_key, child, member(path, name), 0, scope);
      }
      return;
    case Key::Kind::vector:
      parameter(path, key);
      for (int i = 0; i < 3; ++i) read(component_key(key), value[static_cast<std::size_t>(i)], path, i, scope);
      return;
    case Key::Kind::list:
      for (std::size_t i = 0; i < value.size(); ++i) read(key.keys.front(), value[i], element(path, i), 0, scope);
      return;
    case Key::Kind::guesses:
      for (std::size_t i = 0; i < value.size(); ++i) {
        read(guess_key("guess", "initial guess of cg"), value[i], element(path, i), 0, scope);
      }
      return;
    case Key::Kind::guess: return read_guess(value, path, key, scope);
    case Key::Kind::boolean:
    case Key::Kind::integer:
    case Key::Kind::number:
    case Key::Kind::choice:
    case Key::Kind::text: {
      Fixed fixed{parameter(path, key), component, 0.0};
      if (value.is_string())
        fixed.value = value.get<std::string>();
      else
        fixed.value = value.is_boolean() ? value.get<bool>() : value.get<double>();
      scope.fixed.push_back(std::move(fixed));
    }
  }
}

void SweepSpace::read_guess(const Json& value, const std::string& path, const Key& key, Scope& scope) {
  const auto guess = value.begin();
  scope.fixed.push_back({parameter(path, key), 0, guess.key()});
  for (const auto& [name, child] : guess.value().items()) {
    const Key* child_key = find_key(find_key(guess_keys(), guess.key())->keys, name);
    if (child_key) read(*child_key, child, path + "." + guess.key() + "." + name, 0, scope);  // all but the label
  }
}

void SweepSpace::read_sweep(const Key& key, const Json& value, const std::string& path, int component, Scope& scope) {
  const std::string word = value.begin().key();
  const Json& content = value.begin().value();
  if (!is_listed(word)) {
    scope.draws.push_back(draw(key, value, path, component));
    return;
  }
  if (word == "grid") {
    Axis axis;
    axis.options.resize(content.size());
    for (std::size_t i = 0; i < content.size(); ++i) read(key, content[i], path, component, axis.options[i]);
    scope.axes.push_back(std::move(axis));
    return;
  }
  if (scope.zip_axis < 0) {
    scope.zip_axis = static_cast<int>(scope.axes.size());
    scope.zip_path = path;
    scope.axes.emplace_back().options.resize(content.size());
  }
  const auto axis = static_cast<std::size_t>(scope.zip_axis);
  const std::size_t length = scope.axes[axis].options.size();
  if (content.size() != length) {
    throw job_error(file_, path, "this zip has {} values, but {} has {}; all zips must have the same length",
                    content.size(), scope.zip_path, length);
  }
  for (std::size_t i = 0; i < length; ++i) read(key, content[i], path, component, scope.axes[axis].options[i]);
}

SweepSpace::Draw SweepSpace::draw(const Key& key, const Json& range, const std::string& path, int component) {
  const std::string word = range.begin().key();
  const Json& ends = range.begin().value();
  const std::string drawn = component == 0 ? path : element(path, static_cast<std::size_t>(component));
  Draw draw{parameter(path, key), component, Range::uniform, ends[0].get<double>(), ends[1].get<double>(),
            random_stream(drawn), nullptr};
  if (word == "log_uniform") draw.range = Range::log_uniform;
  if (word == "integer") draw.range = Range::integer;
  if (is_even_) {
    std::shared_ptr<const EvenSequence>& sequence = sequences_[drawn];
    if (!sequence) sequence = std::make_shared<const EvenSequence>(key.sobol_dimension, seed_, draw.stream);
    draw.sequence = sequence;
  }
  return draw;
}

void SweepSpace::count(Scope& scope) {
  double points = 1;
  scope.random = !scope.draws.empty();
  for (Axis& axis : scope.axes) {
    axis.first.assign(1, 0);
    bool random = true;
    for (Scope& option : axis.options) {
      count(option);
      random = random && option.random;
      axis.first.push_back(saturated(static_cast<double>(axis.first.back()) + static_cast<double>(option.points)));
    }
    scope.random = scope.random || random;
    points *= static_cast<double>(axis.points());
  }
  scope.points = saturated(points);
}

bool SweepSpace::can_be(const std::string& path, const std::string& word) const {
  const int i = find(path);
  return i >= 0 && can_be(root_, i, word);
}

bool SweepSpace::can_be(const Scope& scope, int parameter, const std::string& word) {
  for (const Fixed& fixed : scope.fixed) {
    if (fixed.parameter == parameter && fixed.value == std::variant<double, std::string>(word)) return true;
  }
  for (const Axis& axis : scope.axes) {
    for (const Scope& option : axis.options) {
      if (can_be(option, parameter, word)) return true;
    }
  }
  return false;
}

void SweepSpace::fill(Point& point, std::int64_t grid_point, std::int64_t sample) const {
  point.index_ = &index_;
  point.values_.assign(parameters_.size(), Point::Value{});
  fill(root_, point, grid_point, static_cast<std::uint64_t>(sample));
}

void SweepSpace::fill(const Scope& scope, Point& point, std::int64_t index, std::uint64_t sample) const {
  for (const Fixed& fixed : scope.fixed) {
    Point::Value& value = point.values_[static_cast<std::size_t>(fixed.parameter)];
    if (const auto* text = std::get_if<std::string>(&fixed.value)) {
      value.state = Point::Value::State::text;
      value.text = text;
    } else {
      value.state = Point::Value::State::number;
      value.number[fixed.component] = std::get<double>(fixed.value);
    }
  }
  for (const Draw& draw : scope.draws) {
    Point::Value& value = point.values_[static_cast<std::size_t>(draw.parameter)];
    const double u = draw.sequence ? draw.sequence->unit(sample) : random_unit(seed_, sample, draw.stream);
    double drawn = draw.low + u * (draw.high - draw.low);
    if (draw.range == Range::log_uniform) {
      drawn = std::exp(std::log(draw.low) + u * (std::log(draw.high) - std::log(draw.low)));
    }
    if (draw.range == Range::integer) drawn = draw.low + std::floor(u * (draw.high - draw.low + 1));
    value.state = Point::Value::State::number;
    value.number[draw.component] = std::clamp(drawn, draw.low, draw.high);
  }
  for (auto axis = scope.axes.rbegin(); axis != scope.axes.rend(); ++axis) {
    const std::int64_t within = index % axis->points();
    index /= axis->points();
    const auto option = std::upper_bound(axis->first.begin(), axis->first.end(), within) - axis->first.begin() - 1;
    const auto o = static_cast<std::size_t>(option);
    fill(axis->options[o], point, within - axis->first[o], sample);
  }
}

}  // namespace rodsweep
