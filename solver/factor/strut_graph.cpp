#include "solver/factor/strut_graph.hpp"

#include <utility>

namespace rodsweep {
namespace {

/// Walks over the rod from crossing to crossing.
class Walk {
 public:
  explicit Walk(const Rod& rod) : rod_(rod), joints_of_(at(rod.segment_count())), crossing_(joints_of_.size(), false) {
    for (int k = 0; k < rod.joint_count(); ++k) {
      joints_of_[at(joint(k).a)].push_back(k);
      joints_of_[at(joint(k).b)].push_back(k);
      if (joint(k).arm_a.isZero() && joint(k).arm_b.isZero())
        crossing_[at(joint(k).a)] = crossing_[at(joint(k).b)] = true;
    }
    for (std::size_t s = 0; s < crossing_.size(); ++s)
      crossing_[s] = !rod.segments[s].is_static && (crossing_[s] || joints_of_[s].size() > 2);
    seen_.assign(crossing_.size(), false);
  }

  StrutGraph graph() {
    number_crossings();
    for (int s = 0; s < rod_.segment_count(); ++s)  // from a segment at an end of a strut
      if (is_inner(s) && ends_at(s)) add_strut(s);
    for (int s = 0; s < rod_.segment_count(); ++s)  // rings
      if (is_inner(s)) {
        crossing_[at(s)] = true;
        add_crossing(s);
        add_strut(beyond(joints_of_[at(s)].front(), s));
      }
    for (int k = 0; k < rod_.joint_count(); ++k)
      if (!is_strut_segment(joint(k).a) && !is_strut_segment(joint(k).b)) out_.links.push_back(k);
    return std::move(out_);
  }

 private:
  const Joint& joint(int k) const { return rod_.joints[at(k)]; }
  int beyond(int k, int segment) const { return joint(k).a == segment ? joint(k).b : joint(k).a; }
  bool is_strut_segment(int s) const { return !rod_.segments[at(s)].is_static && !crossing_[at(s)]; }
  bool is_inner(int s) const { return is_strut_segment(s) && !seen_[at(s)]; }
  bool ends_at(int s) const {
    if (joints_of_[at(s)].size() < 2) return true;
    for (const int k : joints_of_[at(s)])
      if (!is_strut_segment(beyond(k, s))) return true;
    return false;
  }

  void add_crossing(int s) {
    out_.place[at(s)] = static_cast<int>(out_.crossings.size());
    out_.crossings.push_back(s);
  }

  /// Numbers crossings node by node (those joined by links without arms), nodes by their first segment.
  void number_crossings() {
    out_.place.assign(crossing_.size(), -1);
    std::vector<int> queue;
    for (int first = 0; first < rod_.segment_count(); ++first) {
      if (!crossing_[at(first)] || out_.place[at(first)] >= 0) continue;
      queue.assign(1, first);
      while (!queue.empty()) {
        const int s = queue.back();
        queue.pop_back();
        if (out_.place[at(s)] >= 0) continue;
        add_crossing(s);
        for (const int k : joints_of_[at(s)])
          if (joint(k).arm_a.isZero() && joint(k).arm_b.isZero() && crossing_[at(beyond(k, s))])
            queue.push_back(beyond(k, s));
      }
    }
  }

  /// Adds the strut that begins at segment s, next to one of its ends.
  void add_strut(int s) {
    Strut strut;
    const std::vector<int>& own = joints_of_[at(s)];
    int before = -1;  // the joint at the strut's begin; none at a free end
    if (own.size() > 1)
      for (const int k : own)
        if (before < 0 && !is_strut_segment(beyond(k, s))) before = k;
    strut.begin = before < 0 ? -1 : out_.place[at(beyond(before, s))];
    strut.joints.push_back(before);
    while (true) {
      seen_[at(s)] = true;
      strut.segments.push_back(s);
      int after = -1;
      for (const int k : joints_of_[at(s)])
        if (k != before) after = k;
      strut.joints.push_back(after);
      if (after < 0) break;
      const int next = beyond(after, s);
      if (!is_strut_segment(next)) {
        strut.end = out_.place[at(next)];
        break;
      }
      before = after;
      s = next;
    }
    out_.struts.push_back(std::move(strut));
  }

  const Rod& rod_;
  std::vector<std::vector<int>> joints_of_;
  std::vector<bool> crossing_, seen_;
  StrutGraph out_;
};

}  // namespace

StrutGraph strut_graph(const Rod& rod) { return Walk(rod).graph(); }

}  // namespace rodsweep
