#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "solver/numbers/rotation.hpp"
#include "solver/scene/scene_parts.hpp"

namespace rodsweep {
namespace {

std::vector<Curve> in_metres(const Curves& p) {
  std::vector<Curve> out = *p.curves;
  for (Curve& curve : out) {
    for (Vector3& point : curve.points) point *= p.unit_m;
    for (double& radius : curve.radii) radius *= p.unit_m;
  }
  return out;
}

/// One end of an edge at a node.
struct End {
  int edge;
  bool is_last;  ///< the edge ends here, and does not begin
};

/// The segments of a graph's edges and held nodes, and their joints.
class Builder {
 public:
  Builder(const Curves& p, const CurveGraph& graph) : p_(p), graph_(graph) {
    for (std::size_t e = 0; e < graph.edges.size(); ++e) add_segment(graph.edges[e]);
    for (const CurveGraph::Node& node : graph.nodes) ends_.push_back(ends(node));
    from_held_ = distances_from_held();
    for (std::size_t n = 0; n < graph.nodes.size(); ++n)
      if (!graph.nodes[n].held && ends_[n].size() > 2) hub_.push_back(widest(ends_[n]));
    is_hub_.resize(graph.edges.size());
    for (const End& hub : hub_) is_hub_[at(hub.edge)] = true;
  }

  std::vector<Rod> rods() {
    const auto count = at(graph_.components);
    std::vector<std::vector<SegmentSpec>> segments(count);
    std::vector<std::vector<Placed>> joints(count);
    std::vector<double> force_n(count);
    number_.resize(graph_.edges.size());
    for (std::size_t e = 0; e < graph_.edges.size(); ++e) {
      const auto c = at(graph_.component[at(graph_.edges[e].from)]);
      number_[e] = static_cast<int>(segments[c].size());
      segments[c].push_back(segments_[e]);
    }
    for (std::size_t c = 0; c < count; ++c) force_n[c] = weight(segments[c], p_);
    std::size_t hub = 0;
    for (std::size_t n = 0; n < graph_.nodes.size(); ++n) {
      const auto c = at(graph_.component[n]);
      const std::vector<End>& own = ends_[n];
      if (graph_.nodes[n].held) {
        const auto wall = static_cast<int>(segments[c].size());
        segments[c].push_back(held_point(graph_.nodes[n].position_m, backward(own.front()).normalized()));
        for (const End& end : own)
          joints[c].push_back(
              {2 * end.edge + (end.is_last ? 1 : -1), clamped(wall, segments[c].back(), end, force_n[c])});
      } else if (own.size() == 2) {
        joints[c].push_back(
            {between(own[0], own[1]), joined(own[0], half(own[0]), own[1], half(own[1]), true, force_n[c])});
      } else if (own.size() > 2) {
        const End& widest = hub_[hub++];
        for (const End& end : own)
          if (end.edge != widest.edge || end.is_last != widest.is_last)
            joints[c].push_back({between(widest, end), joined(widest, Softness(), end, half(end), false, force_n[c])});
      }
    }
    std::vector<Rod> out;
    for (std::size_t c = 0; c < count; ++c) out.emplace_back(segments[c], in_order(joints[c]));
    return out;
  }

 private:
  /// Joints are numbered along the curves. A joint at the end of edge e has the place 2 e + 1.
  struct Placed {
    int place;
    JointSpec joint;
  };
  static std::vector<JointSpec> in_order(const std::vector<Placed>& joints) {
    std::vector<std::pair<int, std::size_t>> order;
    for (std::size_t k = 0; k < joints.size(); ++k) order.emplace_back(joints[k].place, k);
    std::sort(order.begin(), order.end());
    std::vector<JointSpec> out;
    for (const auto& [place, k] : order) out.push_back(joints[k].joint);
    return out;
  }
  static int between(const End& a, const End& b) { return 2 * std::max(a.edge, b.edge) - 1; }

  void add_segment(const CurveEdge& edge) {
    const Vector3 along = edge.to_m - edge.from_m;
    const bool goes_on = !segments_.empty() && graph_.edges[segments_.size() - 1].curve == edge.curve;
    const Quaternion before = goes_on ? segments_.back().orientation : Quaternion::Identity();
    const Quaternion orientation = turn_between(before * Vector3::UnitZ(), along) * before;
    SegmentSpec segment = segment_at(edge.from_m + along / 2, orientation.normalized(), along.norm(), p_);
    segment.radius_m = mean_radius(edge.from_radius, edge.to_radius);
    segment.density_kg_m3 = curve(edge).density_kg_m3.value_or(p_.density_kg_m3);
    segments_.push_back(segment);
  }

  const Curve& curve(const CurveEdge& edge) const { return (*p_.curves)[at(edge.curve)]; }
  const CurveEdge& edge(const End& end) const { return graph_.edges[at(end.edge)]; }
  double radius(const End& end) const { return end.is_last ? edge(end).to_radius : edge(end).from_radius; }

  std::vector<End> ends(const CurveGraph::Node& node) const {
    std::vector<End> out;
    const int number = static_cast<int>(&node - graph_.nodes.data());
    for (const int edge : node.edges) out.push_back({edge, graph_.edges[at(edge)].to == number});
    return out;
  }

  int far_node(const End& end) const { return end.is_last ? edge(end).from : edge(end).to; }

  /// The distance of every node from what is held, along the curves; infinite if nothing of its rod is held.
  std::vector<double> distances_from_held() const {
    std::vector<double> distance(graph_.nodes.size(), std::numeric_limits<double>::infinity());
    std::set<std::pair<double, int>> next;
    const auto reach = [&](int node, double from_held) {
      if (from_held < distance[at(node)]) next.emplace(distance[at(node)] = from_held, node);
    };
    for (std::size_t n = 0; n < graph_.nodes.size(); ++n)
      if (graph_.nodes[n].held) reach(static_cast<int>(n), 0);
    while (!next.empty()) {
      const auto [from_held, node] = *next.begin();
      next.erase(next.begin());
      if (from_held > distance[at(node)]) continue;
      for (const End& end : ends_[at(node)]) reach(far_node(end), from_held + segments_[at(end.edge)].length_m);
    }
    return distance;
  }

  /// The widest edge of a node. Of equal ones, the shortest; the one that leads to what is held, as the trunk at a fork
  /// of a tree; and one by its direction: the order of the curves does not matter.
  End widest(std::vector<End> of) const {
    const auto keep_least = [&of](const auto& value) {
      constexpr double rounding = 1e-9;
      double least = std::numeric_limits<double>::infinity();
      for (const End& end : of) least = std::min(least, value(end));
      const double most = least + rounding * std::abs(least);
      of.erase(std::remove_if(of.begin(), of.end(), [&](const End& end) { return value(end) > most; }), of.end());
    };
    keep_least([this](const End& end) { return -radius(end); });
    keep_least([this](const End& end) { return segments_[at(end.edge)].length_m; });
    keep_least([this](const End& end) { return from_held_[at(far_node(end))]; });
    for (const int axis : {0, 1, 2}) keep_least([&](const End& end) { return 2 + director(backward(end))[axis]; });
    return of.front();
  }

  /// The part of an edge that belongs to the joint at this end.
  Softness half(const End& end) const {
    const CurveEdge& of = edge(end);
    const double middle = (of.from_radius + of.to_radius) / 2, length = segments_[at(end.edge)].length_m / 2;
    const Curve& material = curve(of);
    const auto section = [&](double radius) {
      return circular_section(radius, material.youngs_modulus_pa.value_or(p_.youngs_modulus_pa),
                              material.torsion_modulus_pa.value_or(p_.torsion_modulus_pa));
    };
    const auto part = [&](bool last) { return cone(middle, last ? of.to_radius : of.from_radius, length, section); };
    return is_hub_[at(end.edge)] ? part(false) + part(true) : part(end.is_last);
  }

  static Quaternion half_turn() { return {0, 1, 0, 0}; }  // about x
  /// Turns a segment's frame so that its z axis points out of the segment at this end, or into it.
  static Quaternion outwards(const End& end) { return end.is_last ? Quaternion::Identity() : half_turn(); }
  static Quaternion inwards(const End& end) { return end.is_last ? half_turn() : Quaternion::Identity(); }
  Quaternion onward(const End& end) const { return segments_[at(end.edge)].orientation * outwards(end); }
  Quaternion backward(const End& end) const { return segments_[at(end.edge)].orientation * inwards(end); }
  Vector3 arm(const End& end) const { return {0, 0, (end.is_last ? 0.5 : -0.5) * segments_[at(end.edge)].length_m}; }

  /// From end a to end b. In a', the frame of a that points out of it, rest and principal axes are those of a chain.
  JointSpec joined(const End& a, const Softness& of_a, const End& b, const Softness& of_b, bool may_be_straight,
                   double force_n) const {
    Quaternion rest = (onward(a).conjugate() * backward(b)).normalized();
    if (may_be_straight && p_.rest_shape == Curves::RestShape::straight) {
      const Quaternion twist(rest.w(), 0, 0, rest.z());
      rest = twist.norm() < 1e-12 ? Quaternion::Identity() : twist.normalized();  // no twist if the curve turns back
    }
    JointSpec joint{number_[at(a.edge)], number_[at(b.edge)], arm(a), arm(b)};
    const Series series = in_series(of_a, of_b, rest);
    joint.rest = (outwards(a) * rest * inwards(b).conjugate()).normalized();
    joint.frame = (outwards(a) * series.frame).normalized();
    set_compliance(joint, series, (segments_[at(a.edge)].length_m + segments_[at(b.edge)].length_m) / 2, force_n, p_);
    return joint;
  }

  JointSpec clamped(int wall, const SegmentSpec& point, const End& end, double force_n) const {
    const Quaternion rest = (point.orientation.conjugate() * backward(end)).normalized();
    JointSpec joint{wall, number_[at(end.edge)], Vector3::Zero(), arm(end)};
    const Series series = in_series(Softness(), half(end), rest);
    joint.rest = (rest * inwards(end).conjugate()).normalized();
    joint.frame = series.frame;
    set_compliance(joint, series, segments_[at(end.edge)].length_m / 2, force_n, p_);
    return joint;
  }

  const Curves& p_;
  const CurveGraph& graph_;
  std::vector<SegmentSpec> segments_;  ///< of the edges
  std::vector<std::vector<End>> ends_;
  std::vector<double> from_held_;  ///< of every node
  std::vector<End> hub_;           ///< of the nodes of three and more edges, in their order
  std::vector<bool> is_hub_;
  std::vector<int> number_;  ///< of each edge's segment in its rod
};

}  // namespace

std::shared_ptr<const CurveGraph> Curves::graph() const {
  struct Last {
    Curves of;  ///< keeps the curves, so that others have another address
    std::shared_ptr<const CurveGraph> graph;
  };
  static thread_local Last last;
  const auto what = [](const Curves& p) { return std::tie(p.curves, p.unit_m, p.radius_m, p.how); };
  if (!last.graph || !(what(last.of) == what(*this)))
    last = {*this, std::make_shared<const CurveGraph>(cut(in_metres(*this), radius_m, how))};
  return last.graph;
}

void Curves::check() const {
  if (!curves) throw SceneError("curves need a file");
}

SceneSize Curves::size() const {
  const std::shared_ptr<const CurveGraph> cut = graph();
  check_segments("curves", static_cast<double>(cut->edges.size()));
  SceneSize size{static_cast<int>(cut->edges.size()), 0, cut->components, "the number of unconnected curves"};
  for (const CurveGraph::Node& node : cut->nodes) {
    const int edges = static_cast<int>(node.edges.size());
    size.segments += node.held ? 1 : 0;
    size.joints += node.held ? edges : edges - 1;
  }
  return size;
}

void Curves::build(Scene& scene) const {
  const std::shared_ptr<const CurveGraph> cut = graph();
  scene.rods = Builder(*this, *cut).rods();
}

}  // namespace rodsweep
