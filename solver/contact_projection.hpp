// Contacts within a time step, as complementarity with Coulomb friction, solved by projected Gauss-Seidel (Jean 1999)
// on accumulated multipliers (XPBD, Macklin et al. 2016), alternately with the projection of the rods:
//
//   gap - allowed >= 0,  lambda_n >= 0,  (gap - allowed) lambda_n = 0
//   |lambda_t| <= mu lambda_n;  the tangential slip since the start of the step is 0, or against lambda_t = mu lambda_n
//
// Once a Newton iteration the contacts are linearised at the current positions: normal, gap, and one common point
// midway between the surfaces, at which equal and opposite impulses act on both segments. A few sweeps in a fixed order
// follow; then every segment moves once, x += dx, q <- rotated(q, dtheta). So linear momentum is conserved to rounding,
// and angular momentum as well as by one rotation update, to O(dtheta^2).
//
// The projection of the rods takes back most of what a contact gave a single segment, since it spreads it over the
// whole rod, so alternation alone converges like 1 - 1 / N for N segments that move as one. But a whole iteration is a
// step of a projected gradient method for the multipliers, with segments that are freer than the rods as its safe
// metric, so Nesterov's acceleration applies (APGD, Mazhar et al. 2015). Multipliers start from 0 in every step, like
// the rods': those of the last step would be a delayed feedback, unstable where a step leaves more than half of the
// error.
//
// Allocates only when there are more contacts than ever before, and where the broad phase searches anew.
#pragma once

#include "solver/contact.hpp"

namespace rodsweep {

class ContactProjection {
 public:
  ContactProjection(Scene& scene, const ContactSettings& settings);

  /// To be called before the scene leaves p.
  void start_step();

  /// To be called at p*: finds the contacts of the step.
  void find();

  /// To be called after the rods' projection. Returns whether the contacts had converged: then nothing is moved.
  /// `last`: nothing comes after it in this step.
  bool project(bool last);

  const std::vector<Contact>& contacts() const { return contacts_; }

  /// The deepest overlap of two bodies in the current state, relative to the smaller radius of the two; 0 if none.
  double penetration();

 private:
  /// A contact at the current positions.
  struct Linear {
    Vector3 arm_a, arm_b;  ///< from the centres to the common point
    double gap;            ///< less what is allowed
    Vector3 slip;          ///< of a's material against b's at the common point, since the start of the step
    double normal_weight;  ///< n (J M^-1 J^T) n [1/kg]
    double size;           ///< that motions are relative to: the smaller radius
  };
  struct Motion {
    Vector3 shift, turn;
  };

  void linearise();
  double sweep();
  void accelerate();
  void move();
  void push(const Contact& contact, const Linear& at, const Vector3& impulse);
  Vector3 relative_motion(const Contact& contact, const Linear& at) const;
  double weight(const Contact& contact, const Linear& at, const Vector3& direction) const;
  Vector3 turn(int body, const Vector3& moment) const;
  Vector3 slip(int body, const Vector3& point) const;
  Vector3 admissible(const Contact& contact, const Vector3& impulse) const;

  Scene& scene_;
  ContactSettings settings_;
  ContactFinder finder_;
  std::vector<Contact> contacts_;
  std::vector<Linear> linear_;
  std::vector<CapsuleAxis> axes_;
  std::vector<Motion> motion_;  ///< of every body
  struct OldPose {
    Vector3 position;
    Quaternion orientation;
  };
  std::vector<OldPose> old_;     ///< of every segment at p
  std::vector<Vector3> before_;  ///< impulses before the sweeps
  std::vector<Vector3> swept_;   ///< impulses after the sweeps of the last iteration
  double momentum_ = 1;          ///< Nesterov's t
};

}  // namespace rodsweep
