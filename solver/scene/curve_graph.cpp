#include "solver/scene/curve_graph.hpp"

#include <algorithm>
#include <array>
#include <boost/math/interpolators/catmull_rom.hpp>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

#include "solver/scene/scene_parts.hpp"

namespace rodsweep {
namespace {

constexpr double default_join = 1e-6;  ///< of the extent

using Spline = boost::math::catmull_rom<std::array<double, 3>>;

Vector3 on(const Spline& spline, double parameter) {
  const std::array<double, 3> at = spline(parameter);
  return {at[0], at[1], at[2]};
}

/// A point of a curve, maybe between given ones.
struct Sample {
  Vector3 at;
  double radius;
  int given;         ///< index, -1 between them
  double parameter;  ///< of a spline
};

/// A curve as samples, between which it is almost straight.
struct Line {
  std::vector<Sample> samples;
  std::optional<Spline> spline;  ///< empty: straight between samples
};

/// Numbers points; those within a tolerance of the first of them have one number, and meet in their middle.
class Places {
 public:
  explicit Places(double tolerance) : tolerance_(tolerance) {}

  int number_of(const Vector3& point) {
    if (const int found = find(point); found >= 0) {
      const auto i = at(found);
      ++count_[i];
      offset_[i] += point - points_[i];
      return found;
    }
    return add(point);
  }
  /// A number of its own.
  int add(const Vector3& point) {
    points_.push_back(point);
    offset_.push_back(Vector3::Zero());
    count_.push_back(1);
    const int number = static_cast<int>(points_.size()) - 1;
    cells_[cell(point)].push_back(number);
    return number;
  }
  int find(const Vector3& point) const {
    const Cell centre = cell(point);
    Cell near{};
    for (near[0] = centre[0] - 1; near[0] <= centre[0] + 1; ++near[0])
      for (near[1] = centre[1] - 1; near[1] <= centre[1] + 1; ++near[1])
        for (near[2] = centre[2] - 1; near[2] <= centre[2] + 1; ++near[2])
          if (const auto found = cells_.find(near); found != cells_.end())
            for (const int number : found->second)
              if ((points_[at(number)] - point).norm() <= tolerance_) return number;
    return -1;
  }
  std::size_t count() const { return points_.size(); }
  Vector3 middle(int number) const {
    const auto i = at(number);
    return points_[i] + offset_[i] / count_[i];
  }

 private:
  using Cell = std::array<double, 3>;  // of the tolerance's size; whole numbers
  Cell cell(const Vector3& point) const {
    return {std::floor(point.x() / tolerance_), std::floor(point.y() / tolerance_), std::floor(point.z() / tolerance_)};
  }

  double tolerance_;
  std::vector<Vector3> points_;  ///< the first ones
  std::vector<Vector3> offset_;  ///< sum over the points of each number, from the first
  std::vector<int> count_;
  std::map<Cell, std::vector<int>> cells_;
};

double extent(const std::vector<Curve>& curves) {
  Eigen::AlignedBox3d box;
  for (const Curve& curve : curves)
    for (const Vector3& point : curve.points) box.extend(point);
  return box.diagonal().norm();
}

/// Adds samples of a spline after `a`, up to and including `b`, so many that it is away from no chord by more than a
/// thousandth of its length. `halvings`: of the span between given points.
void add_samples(const Spline& spline, const Sample& a, const Sample& b, int halvings, std::vector<Sample>& out) {
  constexpr int least = 2, most = 12;
  const double parameter = (a.parameter + b.parameter) / 2;
  const Sample middle{on(spline, parameter), (a.radius + b.radius) / 2, -1, parameter};
  const double off = (middle.at - (a.at + b.at) / 2).norm();
  if (halvings == most || (halvings >= least && off <= 1e-3 * (b.at - a.at).norm())) return out.push_back(b);
  add_samples(spline, a, middle, halvings + 1, out);
  add_samples(spline, middle, b, halvings + 1, out);
}

Spline spline_through(const Curve& curve) {
  const std::vector<Vector3>& given = curve.points;
  const std::size_t last = given.size() - 1;
  const bool closed = given.front() == given.back();
  if (closed && last < 4)
    throw SceneError(curve.name + " has " + std::to_string(last) + " points; a closed spline needs at least 4");
  const auto as_point = [](const Vector3& at) { return std::array{at.x(), at.y(), at.z()}; };
  std::vector<std::array<double, 3>> points;
  if (!closed) points.push_back(as_point(2 * given[0] - given[1]));
  for (std::size_t i = 0; i < last; ++i) points.push_back(as_point(given[i]));
  if (!closed) {  // Boost takes the last point as that before the first: reflections are in between
    points.push_back(as_point(given[last]));
    points.push_back(as_point(2 * given[last] - given[last - 1]));
  }
  return Spline(std::move(points), closed);
}

Line line_of(const Curve& curve, double radius, Interpolation interpolation) {
  Line out;
  const std::size_t last = curve.points.size() - 1;
  const bool closed = curve.points.front() == curve.points.back();
  if (interpolation == Interpolation::spline) out.spline = spline_through(curve);
  const auto given = [&](std::size_t i) {
    double parameter = 0;
    if (out.spline)
      parameter =
          closed && i == last ? out.spline->max_parameter() : out.spline->parameter_at_point(i + (closed ? 0 : 1));
    return Sample{curve.points[i], curve.radii.empty() ? radius : curve.radii[i], static_cast<int>(i), parameter};
  };
  out.samples.push_back(given(0));
  for (std::size_t i = 1; i <= last; ++i)
    if (out.spline)
      add_samples(*out.spline, given(i - 1), given(i), 0, out.samples);
    else
      out.samples.push_back(given(i));
  return out;
}

/// The tolerance of meeting points.
double tolerance_of(const std::vector<Curve>& curves, double join_m) {
  return join_m > 0 ? join_m : default_join * extent(curves);
}

/// Throws SceneError for a point within `least` of the one before.
void check_apart(const Curve& curve, double least, double tolerance) {
  for (std::size_t i = 1; i < curve.points.size(); ++i)
    if ((curve.points[i] - curve.points[i - 1]).norm() <= least)
      throw SceneError("point " + std::to_string(i + 1) + " of " + curve.name + " is at " + text_of(curve.points[i]) +
                       ", as the one before; must be farther away than twice join_m, " + std::to_string(2 * tolerance) +
                       " m");
}

void check(const Curve& curve, double tolerance) {
  if (curve.points.size() < 2)
    throw SceneError(curve.name + " has " + std::to_string(curve.points.size()) + " points; must have at least 2");
  check_apart(curve, 2 * tolerance, tolerance);
  for (std::size_t i = 0; i < curve.radii.size(); ++i)
    if (!(curve.radii[i] > 0))
      throw SceneError("the radius of point " + std::to_string(i + 1) + " of " + curve.name + " is " +
                       std::to_string(curve.radii[i]) + "; must be positive");
}

/// Cuts samples [first, last] of a curve into equal pieces.
class Cutter {
 public:
  Cutter(CurveGraph& graph, const Line& line, int curve)
      : graph_(graph), spline_(line.spline), samples_(line.samples), curve_(curve) {
    arc_.push_back(0);
    for (std::size_t i = 1; i < samples_.size(); ++i)
      arc_.push_back(arc_.back() + (samples_[i].at - samples_[i - 1].at).norm());
  }

  double length(std::size_t first, std::size_t last) const { return arc_[last] - arc_[first]; }

  void cut(std::size_t first, std::size_t last, int from, int to, int pieces) {
    int node = from;
    Sample here = samples_[first];
    for (int piece = 1; piece <= pieces; ++piece) {
      const Sample there =
          piece == pieces ? samples_[last] : sample(arc_[first] + length(first, last) * piece / pieces, first, last);
      const int next = piece == pieces ? to : new_node(there.at);
      const int edge = static_cast<int>(graph_.edges.size());
      graph_.edges.push_back({curve_, node, next, here.at, there.at, here.radius, there.radius});
      for (const int end : {node, next}) graph_.nodes[at(end)].edges.push_back(edge);
      node = next;
      here = there;
    }
  }

 private:
  Sample sample(double arc, std::size_t first, std::size_t last) const {
    const auto next = std::upper_bound(arc_.begin() + static_cast<std::ptrdiff_t>(first) + 1,
                                       arc_.begin() + static_cast<std::ptrdiff_t>(last), arc);
    const auto i = static_cast<std::size_t>(next - arc_.begin());
    const double part = (arc - arc_[i - 1]) / (arc_[i] - arc_[i - 1]);
    const Sample &a = samples_[i - 1], &b = samples_[i];
    const double parameter = a.parameter + part * (b.parameter - a.parameter);
    const Vector3 at = spline_ ? on(*spline_, parameter) : Vector3(a.at + part * (b.at - a.at));
    return {at, a.radius + part * (b.radius - a.radius), -1, parameter};
  }
  int new_node(const Vector3& at) {
    graph_.nodes.push_back({at, false, {}});
    return static_cast<int>(graph_.nodes.size()) - 1;
  }

  CurveGraph& graph_;
  const std::optional<Spline>& spline_;
  const std::vector<Sample>& samples_;
  int curve_;
  std::vector<double> arc_;
};

void number_components(CurveGraph& graph) {
  graph.component.assign(graph.nodes.size(), -1);
  for (std::size_t start = 0; start < graph.nodes.size(); ++start) {
    if (graph.component[start] >= 0) continue;
    std::vector<int> next{static_cast<int>(start)};
    graph.component[start] = graph.components;
    while (!next.empty()) {
      const auto node = at(next.back());
      next.pop_back();
      for (const int e : graph.nodes[node].edges)
        for (const int end : {graph.edges[at(e)].from, graph.edges[at(e)].to})
          if (graph.component[at(end)] < 0) {
            graph.component[at(end)] = graph.components;
            next.push_back(end);
          }
    }
    ++graph.components;
  }
}

/// The places of curves' points.
struct Joined {
  Places places;
  std::vector<std::vector<int>> numbers;  ///< of each curve's points
};

/// Moves points that meet to one place.
Joined join(std::vector<Curve>& curves, double join_m) {
  const double tolerance = tolerance_of(curves, join_m);
  if (curves.empty() || !(tolerance > 0)) throw SceneError("curves need a curve of two points");
  for (const Curve& curve : curves) check(curve, tolerance);
  Joined out{Places(tolerance), {}};
  for (const Curve& curve : curves) {
    std::vector<int>& own = out.numbers.emplace_back();
    for (const Vector3& point : curve.points) {
      const bool turns_back = curve.points.size() == 3 && own.size() == 2 && out.places.find(point) == own.front();
      own.push_back(turns_back ? out.places.add(point) : out.places.number_of(point));
    }
  }
  for (std::size_t c = 0; c < curves.size(); ++c) {
    for (std::size_t i = 0; i < curves[c].points.size(); ++i)
      curves[c].points[i] = out.places.middle(out.numbers[c][i]);
    check_apart(curves[c], 0, tolerance);
  }
  return out;
}

}  // namespace

bool operator==(const CurveCut& a, const CurveCut& b) {
  const auto all = [](const CurveCut& of) {
    const auto& [interpolation, segment_m, join_m, held, held_at_m] = of;
    return std::tie(interpolation, segment_m, join_m, held, held_at_m);
  };
  return all(a) == all(b);
}

double joining_shift(const std::vector<Curve>& curves, double join_m) {
  std::vector<Curve> joined = curves;
  join(joined, join_m);
  double most = 0;
  for (std::size_t c = 0; c < curves.size(); ++c)
    for (std::size_t i = 0; i < curves[c].points.size(); ++i)
      most = std::max(most, (joined[c].points[i] - curves[c].points[i]).norm());
  return most;
}

CurveGraph cut(std::vector<Curve> curves, double radius, const CurveCut& how) {
  const Joined joined = join(curves, how.join_m);
  const Places& places = joined.places;
  const std::vector<std::vector<int>>& numbers = joined.numbers;
  std::vector<int> branches(places.count(), 0);  // lines that leave a place
  std::vector<char> is_node(places.count(), 0), held(places.count(), 0);
  for (const std::vector<int>& own : numbers)
    for (std::size_t i = 0; i < own.size(); ++i) {
      const bool end = i == 0 || i + 1 == own.size();
      const auto place = at(own[i]);
      if (end || branches[place] > 0) is_node[place] = 1;
      branches[place] += end ? 1 : 2;
    }
  for (const Vector3& point : how.held_at_m) {
    const int place = places.find(point);
    if (place < 0)
      throw SceneError("held_at_m has " + text_of(point) + ", which is no point of a curve (within join_m)");
    is_node[at(place)] = held[at(place)] = 1;
  }

  CurveGraph graph;
  std::vector<int> node_of(places.count(), -1);
  const auto add_node = [&](int place, bool is_held) {
    node_of[at(place)] = static_cast<int>(graph.nodes.size());
    graph.nodes.push_back({places.middle(place), is_held, {}});
  };
  for (std::size_t place = 0; place < places.count(); ++place) {
    if (!is_node[place]) continue;
    const bool end = how.held == HeldPoints::ends && branches[place] == 1;
    add_node(static_cast<int>(place), held[place] != 0 || end);
  }
  const auto meets = [&](int place) { return branches[at(place)] > 2; };
  for (std::size_t c = 0; c < curves.size(); ++c) {
    const Line line = line_of(curves[c], radius, how.interpolation);
    Cutter cutter(graph, line, static_cast<int>(c));
    std::size_t first = 0;
    for (std::size_t i = 1; i < line.samples.size(); ++i) {
      if (line.samples[i].given < 0) continue;
      const int from = numbers[c][at(line.samples[first].given)];
      const int to = numbers[c][at(line.samples[i].given)];
      const bool drawn = how.segment_m <= 0;
      const bool is_corner = drawn || how.interpolation == Interpolation::linear;  // every given point ends an edge
      if (!is_corner && !is_node[at(to)]) continue;
      for (const int place : {from, to})
        if (node_of[at(place)] < 0) add_node(place, false);
      const double pieces = drawn ? 1 : std::ceil(cutter.length(first, i) / how.segment_m - 1e-9);
      constexpr double most = 1e7;
      require(pieces <= most, "the number of segments of a curve", pieces, "at most 1e7; segment_m must be greater");
      const int least = from == to ? 3 : meets(from) && meets(to) ? 2 : 1;
      cutter.cut(first, i, node_of[at(from)], node_of[at(to)], std::max(least, static_cast<int>(pieces)));
      first = i;
    }
  }
  number_components(graph);
  return graph;
}

}  // namespace rodsweep
