// A validated job's parameters with their sweeps, as a space of points that are computed on demand.
//
//   grid   one axis; its values may be anything that the key takes, whole objects included, and hold sweeps of their
//   own,
//          which belong to that value: the axis is the union of its values' spaces
//   zip    all zips of the job (or of one grid value) form one joint axis, so they are equally long
//   uniform, log_uniform, integer   no axis: drawn for every sample from (seed, sample, key path) alone, so that all
//          grid points share draws; with sampling "sobol" from Sobol's sequence, a dimension for every key path in the
//          order of the job, shifted at random by (seed, key path)
// Axes are crossed in the order in which they stand in the job, the last varying fastest; the joint axis of the zips
// stands where the first of them does.
//
// Throws JobError for zips of different lengths and for more random keys than Sobol's sequence has dimensions.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "runner/job/key.hpp"
#include "runner/job/sobol.hpp"

namespace rodsweep {

/// One parameter: a key of the job that holds a value, wherever it stands among the alternatives of a grid; or one that
/// stands for many, whose value is its option_label().
struct Parameter {
  std::string path;  ///< without the marks of sweeps: "scene.segments", "guesses[2].oracle.error"
  Key key;
};

/// The parameters at one point. Refers to the SweepSpace that filled it.
class Point {
 public:
  bool has(std::string_view path) const;
  bool is_text(std::string_view path) const;  ///< also where a number key holds a word
  double number(std::string_view path) const;
  std::int64_t integer(std::string_view path) const;
  const std::string& text(std::string_view path) const;

  struct Value {
    enum class State : std::uint8_t { absent, number, text };
    State state = State::absent;
    double number[3] = {0, 0, 0};  ///< integers too, which are below 2^53; of a boolean 0 or 1
    const std::string* text = nullptr;
  };
  const Value& operator[](std::size_t parameter) const { return values_[parameter]; }
  const Value& at(std::string_view path) const;  ///< throws std::logic_error where it is absent
  void set(std::size_t parameter, double value);

 private:
  friend class SweepSpace;
  const class SweepSpace* space_ = nullptr;
  std::vector<Value> values_;
};

class SweepSpace {
 public:
  /// `values` as Job::values; `file` for messages.
  SweepSpace(const nlohmann::ordered_json& values, const std::filesystem::path& file);

  std::int64_t grid_points() const { return root_.points; }  ///< saturates at 10^15
  bool every_point_is_random() const { return root_.random; }
  const std::vector<Parameter>& parameters() const { return parameters_; }

  /// Index of every parameter, in the order of paths.
  const std::map<std::string, int, std::less<>>& by_path() const { return index_; }

  /// Index of a parameter, or -1 if the job has none of this path.
  int find(std::string_view path) const;

  /// Is `word` among the values that this text parameter can take?
  bool can_be(std::string_view path, const std::string& word) const;

  void fill(Point& point, std::int64_t grid_point, std::uint64_t seed, std::int64_t sample) const;

 private:
  enum class Range { uniform, log_uniform, integer };
  struct Fixed {
    int parameter, component;
    std::variant<double, std::string> value;
  };
  struct Draw {
    int parameter, component;
    Range range;
    double low, high;
    std::uint64_t stream;
    std::size_t dimension;  ///< of the random keys, in the order of the job
  };
  struct Sample {
    std::uint64_t seed, number;
  };
  struct Axis;
  /// What stands outside any grid or zip, or within one value of it.
  struct Scope {
    std::vector<Fixed> fixed;
    std::vector<Draw> draws;
    std::vector<Axis> axes;
    int zip_axis = -1;
    std::string zip_path;
    std::int64_t points = 1;
    bool random = false;  ///< does every point of it draw something?
  };
  struct Axis {
    std::vector<Scope> options;
    std::vector<std::int64_t> first;  ///< index of each option's first point; one more at the end
    std::int64_t points() const { return first.back(); }
  };

  void read(const Key& key, const nlohmann::ordered_json& value, const std::string& path, int component, Scope& scope);
  void read_sweep(const Key& key, const nlohmann::ordered_json& value, const std::string& path, int component,
                  Scope& scope);
  void read_guess(const nlohmann::ordered_json& value, const std::string& path, const Key& key, Scope& scope);
  int parameter(const std::string& path, const Key& key);
  static void count(Scope& scope);
  static bool can_be(const Scope& scope, int parameter, const std::string& word);
  void fill(const Scope& scope, Point& point, std::int64_t index, const Sample& sample) const;
  double unit(const Draw& draw, const Sample& sample) const;

  std::filesystem::path file_;
  std::vector<Parameter> parameters_;
  std::map<std::string, int, std::less<>> index_;
  std::map<std::string, std::size_t> dimensions_;  ///< of the random keys, by path
  std::optional<SobolSequence> sobol_;
  Scope root_;
};

}  // namespace rodsweep
