// The motion of bodies under the impulses of their contacts, within one Newton iteration and to first order.
//
// While contacts are only measured (measure()), a push moves a segment at once, as if it were free. While rods respond
// (respond()), pushes move them at the next settle(), with the response of their joints (rod_response.hpp). Meanwhile
// coupling() tells how segments move by impulses on others: in rods with a Delassus operator (rod_response.hpp) as
// they will, in others as if they were free. At the end every segment moves once, by dx and dtheta, and
// lambda += dlambda. Obstacles and static segments do not move.
//
// Impulses change velocities, which a step measures from poses x^, q^ (free_flight.hpp): h v = x - x^, h w =
// rotation(q, q^). So a contact slips with h (v + w x arm), and the part of dtheta about w adds to h w (turned()): friction
// acts on the spin itself, also if a thin segment turns by radians in a step.
//
// The response of a rod with a Delassus operator is assembled once in a step, unless its segments turn
// (RodResponse::is_stale): the next Newton iteration sees where the bodies are. Others are assembled in each iteration.
#pragma once

#include <optional>
#include <vector>

#include "solver/contact/contact_bodies.hpp"
#include "solver/contact/rod_response.hpp"

namespace rodsweep {

/// A point of a body: `arm` from its centre.
struct BodyPoint {
  int body;
  Vector3 arm;
};

/// Of a rod's segments: velocities at the end of the step are the motion from here over h.
struct PastPoses {
  std::vector<Vector3> position;
  std::vector<Quaternion> orientation;
  double h = 0;
};

class ContactMotion {
 public:
  ContactMotion(Scene& scene, const ContactBodies& bodies);

  /// Call in each step before the others: impulses are forces times unit_dt^2 [kg m], also between rods whose
  /// multipliers are forces times the squares of other constraint_dt.
  void start_step(double unit_dt);
  PastPoses& past(std::size_t rod) { return rods_[rod].past; }
  /// h of the rod of a segment.
  double h(int segment) const { return coupled(segment).past.h; }
  /// The velocity of a segment's material at a point, in its present pose [m/s].
  Vector3 velocity(const BodyPoint& point) const;
  Vector3 velocity_before(const BodyPoint& point) const;  ///< at the start of the step
  /// The part of an impulse's moment that turns a segment in the balance of momentum as turned() does.
  Vector3 turning(int segment, const Vector3& moment) const;

  /// Whether a body moves without joints.
  bool is_single(int body) const;

  /// What a rod gets of an impulse.
  double share(int rod) const { return rods_[at(rod)].share; }

  /// From now on all segments are free, until respond(). The axes must outlive the iteration.
  void measure(const std::vector<CapsuleAxis>& axes) { axes_ = &axes, responds_ = false; }
  /// Discards all pushes since measure().
  void clear();

  /// From now on rods respond. Call before touch().
  void respond();
  /// Contacts may push this body. Call update() after the last.
  void touch(int body);
  void update();

  /// The motion of a point per impulse at another of the same group [1/kg].
  Matrix3 coupling(const BodyPoint& of, const BodyPoint& by) const;
  /// W of two bodies' points: their relative motion per impulse.
  Matrix3 mobility(const BodyPoint& a, const BodyPoint& b) const;
  /// Bodies of different groups are not coupled: a rod with a Delassus operator, a body of another; -1: does not move.
  int group(int body) const;

  /// An impulse at a body's point.
  void push(const BodyPoint& point, const Vector3& impulse);

  /// The motion of a body's point.
  Vector3 of(const BodyPoint& point) const;

  /// Whether a touched rod has no Delassus operator.
  bool needs_settling() const;
  /// Whether a touched rod has one.
  bool couples_segments() const;
  /// Moves all segments of the rods that were pushed.
  void settle();

  /// Moves the bodies by the settled motions, then resets all motions. With the balance of momentum kept, joints keep
  /// their forces in the world (momentum_balance.hpp).
  void apply(bool keeps_balance);

 private:
  struct Coupled {
    int first_body;
    PastPoses past;
    double share = 1;
    std::optional<RodResponse> response{};  ///< after the first touch
    DelassusOperator delassus;
    bool assembled = false;  ///< in this step
    bool touched = false;    ///< in this iteration
    bool pushed = false;     ///< since the last settle()
  };
  const Segment& segment(const Body& of) const;
  const Coupled& coupled(int segment) const { return rods_[at(bodies_.body(segment).rod)]; }
  Lane8 free_motion(int body, const Lane8& wrench) const;

  Scene& scene_;
  const ContactBodies& bodies_;
  std::vector<Coupled> rods_;
  const std::vector<CapsuleAxis>* axes_ = nullptr;
  bool responds_ = false;
  std::vector<Lane8> motion_;   ///< of every body: dx in lanes 0..2, dtheta in lanes 3..5
  std::vector<Lane8> settled_;  ///< after the joints' response
  std::vector<Lane8> wrench_;   ///< impulses and their moments since the last settle()
};

}  // namespace rodsweep
