// The contacts of a step, found once from where everything is at its start, p, and where it would go freely, p* (Shao
// et al. 2021), so that nothing passes through anything else however fast it is.
//
// A contact keeps two capsules at least R = r_a + r_b apart, axis from axis, measured along a normal n from b to a. It
// is on the right side from the start: n is taken where the axes first come as near as R on their straight way from p
// to p*, wherever they could have crossed on it, else at p*. Later n follows the closest points as long as it turns by
// less than a right angle at once; otherwise the axes have crossed, and n stays (see follow()). Contacts of the last
// step pass their side on, so that axes which ended a step crossed are still pushed back.
//
// Where one of the closest points is the end of a segment and the rod goes on there towards the other, its next segment
// is nearer: that has the contact. Otherwise rods would catch on each other's joints.
//
// There is a contact where the axes can have come as near as 1.2 R; the rods' projection may move them into it.
// Capsules that lie side by side have two, at the ends of their overlap, and so has a capsule on a half-space, at both
// its ends. All others have one, at their closest points. What they penetrate at p is allowed for, but for a share that
// is taken back (ContactSettings::recovery), at most a hundredth of a radius in a step: what a step corrects by a
// distance is a velocity that stays.
#pragma once

#include <vector>

#include "solver/contact/contact_bodies.hpp"

namespace rodsweep {

struct Contact {
  enum class Place { closest, low, high };  ///< on a's axis: closest to b; at s of a smaller and a larger value

  int a;  ///< body, see ContactBodies
  int b;  ///< body after a, or -1 - i of the half-space i
  Place place;
  double s;                  ///< on a's axis, unless closest
  Vector3 normal;            ///< n
  double allowed = 0;        ///< of the gap |x_a - x_b| - R, at most 0 [m]
  Vector3 impulse{0, 0, 0};  ///< on a, so far in the step, at first that of the last: force times dt_c^2 [kg m]
};

/// Where a contact's capsules are nearest, and the gap there along the contact's normal, which follows.
struct Gap {
  double width;    ///< [m]; negative where they overlap
  Vector3 middle;  ///< of it
};

class ContactFinder {
 public:
  ContactFinder(const Scene& scene, double recovery);
  ContactFinder(const ContactFinder&) = delete;  // the broad phase asks the bodies
  ContactFinder& operator=(const ContactFinder&) = delete;

  const ContactBodies& bodies() const { return bodies_; }

  /// To be called at the start of a step, with the time at its end.
  void remember(const Scene& scene, double end_s) {
    start_s_ = scene.time_s;
    end_s_ = end_s;
    bodies_.place(scene, start_);
  }

  /// To be called when the scene has moved on to p*. Replaces the contacts of the last step by those of this one,
  /// sorted by bodies and place; those that last keep their impulses. Returns false, and finds none, where p* is not
  /// finite.
  bool find(const Scene& scene, std::vector<Contact>& contacts);

  /// The bodies' axes as they are now, those of obstacles at the end of the step.
  void place(const Scene& scene, std::vector<CapsuleAxis>& axes) const { bodies_.place(scene, end_s_, axes); }

  /// With these axes.
  Gap follow(Contact& contact, const std::vector<CapsuleAxis>& axes) const { return follow(contact, axes, end_s_); }
  const std::vector<CapsuleAxis>& start() const { return start_; }

  /// By how much an obstacle, or a half-space from -1 downwards, moves in the step.
  Vector3 motion(int obstacle) const;

 private:
  void find_pair(int a, int b, const Vector3* side);
  void find_below(int a, int half_space);
  bool nearer_beyond(int body, int other, double s, const Vector3& away, double time) const;
  void add(Contact contact, bool sided);
  void keep_impulses(const std::vector<Contact>& last);
  Gap follow(Contact& contact, const std::vector<CapsuleAxis>& axes, double time_s) const;

  struct Plane {
    Vector3 point, normal, velocity;
    double height(const Vector3& of, double time_s) const { return normal.dot(of - point - time_s * velocity); }
  };
  ContactBodies bodies_;
  std::vector<Plane> planes_;
  BroadPhase broad_phase_;
  double recovery_;
  double start_s_ = 0, end_s_ = 0;         ///< of the step
  std::vector<CapsuleAxis> start_, free_;  ///< at p and p*
  std::vector<double> reach_;              ///< of every body, how far from its axis its contacts begin [m]
  std::vector<Box> boxes_;
  std::vector<Contact> found_;
};

}  // namespace rodsweep
