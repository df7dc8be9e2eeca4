// The contacts of a step, found once from the positions p at its start and p* after free flight (Shao et al. 2021), so
// that fast bodies do not pass through each other.
//
// A contact keeps the axes of two capsules at least R = r_a + r_b apart, measured along a normal n from b to a. n must
// point to the side on which a was at the start. If the axes could have crossed between p and p*, n is taken at the
// first time when they are R apart on their straight paths, else at p*. Later n follows the closest points while it
// turns by less than a right angle per update; otherwise the axes have crossed, and n is kept (see follow()). A contact
// that persists keeps its side, so that axes that are crossed at the end of a step are still pushed back.
//
// If a closest point is the end of a segment and the rod continues there towards the other body, the contact belongs to
// the next segment, which is nearer. Otherwise rods would catch on each other's joints.
//
// A contact is made if the axes can have come within 1.2 R: the rods' projection may move them into contact. Capsules
// side by side have two contacts, at the ends of their overlap; a capsule on a half-space has two, at its ends; all
// others have one, at their closest points. A penetration at p is allowed, except for a share that is corrected
// (ContactSettings::recovery), at most a hundredth of a radius per step: correcting positions adds a velocity.
//
// With a coefficient of restitution e, a contact whose gap would close in this step has an impact, unless it pressed in
// the last one: instead of the gap, the velocity at which the bodies separate has a lower limit (rebound.hpp). It also has
// one if only the impacts of others close it and it would have closed by the next step: of a rod that falls flat, one end
// may reach the floor first.
#pragma once

#include <vector>

#include "solver/contact/contact_bodies.hpp"

namespace rodsweep {

/// Of an impact with restitution, see rebound.hpp [m].
struct Impact {
  bool possible = false;  ///< the bodies separate if they meet in this step
  bool happens = false;   ///< they would meet
  double gap = 0, acceleration = 0;
  double meeting = 0;  ///< how much nearer they come without impulses, with the response of the joints
  double limit = 0;    ///< of the rebound in this Newton iteration
};

/// Where on the axis of the first body a contact is: closest to the other, or at a lower or higher s.
enum class AxisPlace { closest, low, high };

struct Contact {
  int a;  ///< body, see ContactBodies
  int b;  ///< body after a, or -1 - i for half-space i
  AxisPlace place;
  double s;                  ///< on a's axis, unless closest
  Vector3 normal;            ///< n
  double allowed = 0;        ///< lower limit of the gap |x_a - x_b| - R, without an impact [m]
  Vector3 impulse{0, 0, 0};  ///< on a, in this step so far, starting from the last step's (contact_motion.hpp) [kg m]
  Impact impact{};
};

/// The gap of a contact where its capsules are nearest, along its normal, which follows() updates.
struct Gap {
  double width;        ///< [m]; negative where they overlap
  Vector3 on_a, on_b;  ///< points of the surfaces
};

class ContactFinder {
 public:
  ContactFinder(const Scene& scene, const ContactSettings& settings, bool two_steps = false);
  ContactFinder(const ContactFinder&) = delete;  // broad_phase_ refers to this
  ContactFinder& operator=(const ContactFinder&) = delete;

  const ContactBodies& bodies() const { return bodies_; }

  /// Call at the start of a step, with the time at its end.
  void remember(const Scene& scene, double end_s) {
    start_s_ = scene.time_s;
    end_s_ = end_s;
    bodies_.place(scene, start_);
  }

  /// Call at p*. Replaces the contacts of the last step by those of this one, sorted by bodies and place; contacts that
  /// persist keep their impulses. Returns false and finds none if p* is not finite.
  bool find(const Scene& scene, std::vector<Contact>& contacts);

  /// The bodies' axes as they are now, those of obstacles at the end of the step.
  void place(const Scene& scene, std::vector<CapsuleAxis>& axes) const { bodies_.place(scene, end_s_, axes); }

  /// The gap with these axes. Updates the contact's normal.
  Gap follow(Contact& contact, const std::vector<CapsuleAxis>& axes) const { return follow(contact, axes, end_s_); }
  const std::vector<CapsuleAxis>& start() const { return start_; }

  /// Whether the bodies touch with these axes and have come nearer, without restitution by more than a hundredth of the
  /// smaller radius.
  bool closes(Contact contact, const std::vector<CapsuleAxis>& axes) const;

  /// Half-space i is obstacle -1 - i.
  bool is_obstacle(int body) const { return body < 0 || bodies_.body(body).rod < 0; }
  const Vector3& velocity(int obstacle) const;  ///< [m/s]

 private:
  void find_pair(int a, int b, const Vector3* side);
  void find_below(int a, int half_space);
  bool nearer_beyond(int body, int other, double s, const Vector3& away, double time) const;
  void add(Contact contact, bool sided);
  void keep_impulses(const std::vector<Contact>& last);
  void let_rebound(const Scene& scene);
  Gap follow(Contact& contact, const std::vector<CapsuleAxis>& axes, double time_s) const;

  struct Plane {
    Vector3 point, normal, velocity;
    double height(const Vector3& of, double time_s) const { return normal.dot(of - point - time_s * velocity); }
  };
  ContactBodies bodies_;
  std::vector<Plane> planes_;
  BroadPhase broad_phase_;
  double recovery_, restitution_;
  bool two_steps_;
  double start_s_ = 0, end_s_ = 0;         ///< of the step
  std::vector<CapsuleAxis> start_, free_;  ///< at p and p*
  std::vector<CapsuleAxis> coasting_;      ///< at the end of the step without its forces
  std::vector<double> reach_;              ///< per body: distance from its axis at which contacts begin [m]
  std::vector<Box> boxes_;
  std::vector<Contact> found_;
};

}  // namespace rodsweep
