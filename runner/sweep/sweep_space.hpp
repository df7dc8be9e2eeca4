// A validated job's parameters and sweeps, as a space of points that are computed on demand.
//
//   grid   one axis; its values may be any valid values, including objects that contain sweeps. Such a sweep belongs
//          to that value: the axis is the union of its values' spaces
//   zip    all zips of the job (or of one grid value) form one joint axis, so they have equal lengths
//   uniform, log_uniform, integer   no axis: drawn for each sample only from (seed, sample, key path), so that all
//          grid points share draws. With sampling "sobol", from the key path's sequence in sobol.hpp
// Axes are crossed in job order, the last varying fastest. The joint axis of the zips is at the place of the first zip.
//
// Throws JobError if zips differ in length.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <variant>
#include <vector>

#include "runner/keys/key.hpp"
#include "runner/keys/point.hpp"
#include "runner/sweep/sobol.hpp"

namespace rodsweep {

/// One parameter: a key of the job with a value, in any alternative of a grid; or a key that contains others, whose
/// value is its option_label().
struct Parameter {
  std::string path;  ///< without sweep words: "scene.segments", "guesses[2].oracle.error"
  Key key;
};

class SweepSpace {
 public:
  /// `values` as Job::values; `file` for messages.
  SweepSpace(const nlohmann::ordered_json& values, const std::filesystem::path& file);

  std::int64_t grid_points() const { return root_.points; }  ///< saturates at 10^15
  bool every_point_is_random() const { return root_.random; }
  const std::vector<Parameter>& parameters() const { return parameters_; }

  /// Index of a parameter, or -1 if not found.
  int find(const std::string& path) const;

  /// Whether this text parameter can have the value `word`.
  bool can_be(const std::string& path, const std::string& word) const;

  void fill(Point& point, std::int64_t grid_point, std::int64_t sample) const;

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
    std::shared_ptr<const EvenSequence> sequence;  ///< null: independent
  };
  struct Axis;
  /// The parameters outside any grid or zip, or within one value of it.
  struct Scope {
    std::vector<Fixed> fixed;
    std::vector<Draw> draws;
    std::vector<Axis> axes;
    int zip_axis = -1;
    std::string zip_path;
    std::int64_t points = 1;
    bool random = false;  ///< whether every point draws random values
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
  Draw draw(const Key& key, const nlohmann::ordered_json& range, const std::string& path, int component);
  int parameter(const std::string& path, const Key& key);
  static void count(Scope& scope);
  static bool can_be(const Scope& scope, int parameter, const std::string& word);
  void fill(const Scope& scope, Point& point, std::int64_t index, std::uint64_t sample) const;

  std::filesystem::path file_;
  std::vector<Parameter> parameters_;
  Point::Index index_;
  std::uint64_t seed_;
  bool is_even_;
  std::map<std::string, std::shared_ptr<const EvenSequence>> sequences_;  ///< of the random keys, by path
  Scope root_;
};

}  // namespace rodsweep
