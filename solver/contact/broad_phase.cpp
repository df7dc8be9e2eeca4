#include "solver/contact/broad_phase.hpp"

#include <algorithm>
#include <boost/geometry/geometries/box.hpp>
#include <boost/geometry/geometries/point.hpp>
#include <boost/geometry/index/rtree.hpp>
#include <boost/geometry/strategies/strategies.hpp>
#include <boost/iterator/function_output_iterator.hpp>
#include <utility>

namespace rodsweep {
namespace {

namespace geometry = boost::geometry;
using Corner = geometry::model::point<double, 3, geometry::cs::cartesian>;
using Region = geometry::model::box<Corner>;
using Tree = geometry::index::rtree<std::pair<Region, int>, geometry::index::linear<16>>;

Region region(const Box& box) {
  const Vector3 &low = box.min(), &high = box.max();
  return {{low.x(), low.y(), low.z()}, {high.x(), high.y(), high.z()}};
}

/// A box is enlarged by this many of its last motions, and at most by this many margins.
constexpr double ahead = 8;

}  // namespace

BroadPhase::BroadPhase(std::vector<double> margins, std::function<bool(int, int)> matters)
    : margins_(std::move(margins)), matters_(std::move(matters)) {}

const std::vector<Pair>& BroadPhase::pairs(const std::vector<Box>& boxes) {
  bool inside = kept_.size() == boxes.size();
  for (std::size_t i = 0; inside && i < boxes.size(); ++i) inside = kept_[i].contains(boxes[i]);
  if (!inside) {
    kept_.resize(boxes.size());
    if (last_.size() != boxes.size()) last_ = boxes;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      const double most = ahead * margins_[i];
      const Vector3 further = (ahead * (boxes[i].min() - last_[i].min())).cwiseMax(-most).cwiseMin(most);
      kept_[i] = grown(boxes[i], margins_[i]);
      kept_[i].min() += further.cwiseMin(0);
      kept_[i].max() += further.cwiseMax(0);
    }
    search();
  }
  last_ = boxes;
  return pairs_;
}

void BroadPhase::search() {
  ++searches_;
  std::vector<std::pair<Region, int>> values;
  values.reserve(kept_.size());
  for (std::size_t i = 0; i < kept_.size(); ++i) values.emplace_back(region(kept_[i]), static_cast<int>(i));
  const Tree tree(values.begin(), values.end());
  pairs_.clear();
  for (const auto& [box, a] : values) {
    const auto first = static_cast<std::ptrdiff_t>(pairs_.size());
    tree.query(geometry::index::intersects(box),
               boost::make_function_output_iterator([this, a = a](const std::pair<Region, int>& found) {
                 if (found.second > a && matters_(a, found.second)) pairs_.push_back({a, found.second});
               }));
    std::sort(pairs_.begin() + first, pairs_.end(), [](const Pair& p, const Pair& q) { return p.b < q.b; });
  }
}

}  // namespace rodsweep
