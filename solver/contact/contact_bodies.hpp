// All bodies of a scene that may touch, in one list: the segments of all rods, then balls and capsules among the
// obstacles. A segment is a capsule: its axis is as long as the segment, with a half sphere of its radius at either
// end. A segment without radius (an exact wall) has no contacts.
//
// Two segments of a rod can be in contact only if the path between them along the rod, from joint to joint, is at least
// (pi / 2) (r_a + r_b): nearer ones could touch only if the rod is bent more tightly than its own radius. This
// excludes neighbours and all segments that meet in one point. If segments are shorter than they are wide, it also
// excludes the next neighbours, whose capsules overlap in a straight rod. Where branches leave a node at a sharp angle,
// all pairs are excluded that overlap at rest from the node on: a rod at rest is not pushed by itself. Two static bodies
// are never in contact.
// Throws SceneError for an invalid obstacle.
#pragma once

#include <algorithm>
#include <vector>

#include "solver/contact/broad_phase.hpp"
#include "solver/contact/capsule_distance.hpp"
#include "solver/rod/joint_ways.hpp"
#include "solver/scene/scene.hpp"

namespace rodsweep {

struct Body {
  int rod, segment;  ///< -1 for an obstacle
  double radius, half_length;
  bool is_free;  ///< not static
};

class ContactBodies {
 public:
  explicit ContactBodies(const Scene& scene);

  int count() const { return static_cast<int>(bodies_.size()); }
  const Body& body(int i) const { return bodies_[at(i)]; }

  /// The reference length of a contact's motions; the radius of `a` if b is a half-space, below 0.
  double smaller_radius(int a, int b) const {
    return b < 0 ? body(a).radius : std::min(body(a).radius, body(b).radius);
  }

  /// Whether two bodies, a < b, can be in contact.
  bool matter(int a, int b) const;

  /// The continuation of a rod at an end of a segment: the next segment, and the direction into it along its axis.
  struct Next {
    int end;   ///< end of the segment: -1 or 1
    int body;  ///< the next segment
    int into;  ///< -1 or 1
  };
  const std::vector<Next>& next(int i) const { return next_[at(i)]; }

  /// Axes in the current state of the scene, one for each body, with obstacles at `time_s`.
  void place(const Scene& scene, double time_s, std::vector<CapsuleAxis>& axes) const;
  void place(const Scene& scene, std::vector<CapsuleAxis>& axes) const { place(scene, scene.time_s, axes); }

  /// Axes after dt with the scene's velocities, from `start`, with obstacles at `time_s`.
  void coast(const Scene& scene, const std::vector<CapsuleAxis>& start, double time_s, double dt,
             std::vector<CapsuleAxis>& axes) const;

  /// Velocity of an obstacle [m/s].
  const Vector3& velocity(int obstacle) const {
    return obstacles_[at(obstacle) - (bodies_.size() - obstacles_.size())].velocity;
  }

 private:
  void add(const Obstacle& obstacle);
  void connect(const Rod& rod, int first_body);
  void exclude_neighbours(const Rod& rod, int first_body);
  void exclude_near(const Rod& rod, int first_body, JointWays& ways);
  void exclude_overlapping(const Rod& rod, int first_body, const JointWays& ways);

  std::vector<Body> bodies_;
  struct Moving {
    CapsuleAxis at_time_0;
    Vector3 velocity;
  };
  std::vector<Moving> obstacles_;
  std::vector<std::vector<Next>> next_;     ///< of every body
  std::vector<std::vector<int>> excluded_;  ///< per segment: the later ones that it cannot touch, sorted
};

}  // namespace rodsweep
