// The motion of bodies under the impulses of their contacts, within one Newton iteration and to first order. push()
// moves a segment as if it were free; settle() adds the response of the joints of its rod (rod_response.hpp); at the
// end every segment moves once, x += dx, q <- rotated(q, dtheta), and lambda += dlambda. Obstacles and static segments
// do not move.
#pragma once

#include <optional>
#include <vector>

#include "solver/contact/contact_bodies.hpp"
#include "solver/contact/rod_response.hpp"

namespace rodsweep {

class ContactMotion {
 public:
  ContactMotion(Scene& scene, const ContactBodies& bodies);

  /// W of a body's point, `arm` from its centre: the point's motion per impulse there [1/kg].
  Matrix3 mobility(int body, const Vector3& arm, const CapsuleAxis& axis) const;

  /// Call in each step before the others: impulses are forces times unit_dt^2 [kg m], also between rods whose
  /// multipliers are forces times the squares of other constraint_dt.
  void start_step(double unit_dt);
  /// What a rod gets of an impulse.
  double share(int rod) const { return rods_[static_cast<std::size_t>(rod)].share; }

  /// An impulse at a body's point.
  void push(int body, const Vector3& arm, const Vector3& impulse, const CapsuleAxis& axis);

  /// The motion of a body's point.
  Vector3 of(int body, const Vector3& arm) const;

  void settle();

  /// Moves the bodies by the settled motions, then resets all motions. With the balance of momentum kept, joints keep
  /// their forces in the world (momentum_balance.hpp).
  void apply(bool keeps_balance);

  /// Discards all pushes, which must not have settled.
  void clear();

 private:
  struct Coupled {
    int first_body;
    double share = 1;
    std::optional<RodResponse> response{};  ///< after the first push
    bool pushed = false, assembled = false;
  };
  const Segment& segment(const Body& of) const;

  Scene& scene_;
  const ContactBodies& bodies_;
  std::vector<Coupled> rods_;
  std::vector<Lane8> motion_;   ///< of every body: dx in lanes 0..2, dtheta in lanes 3..5
  std::vector<Lane8> settled_;  ///< after the joints' response
};

}  // namespace rodsweep
