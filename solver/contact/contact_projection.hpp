// Contacts within a time step, as complementarity with Coulomb friction (coulomb_contact.hpp), solved by projected
// Gauss-Seidel (Jean 1999) on accumulated multipliers (XPBD, Macklin et al. 2016), after the projection of the rods.
// Gaps are relative to the allowed gap (contact.hpp), slips to the start of the step.
//
// In every Newton iteration the contacts are linearised at the current positions: normal, gap, and one common point
// midway between the surfaces, at which equal and opposite impulses act on both segments. Then the multipliers are
// iterated: a sweep in a fixed order treats every segment as free, and then the joints respond (contact_motion.hpp).
// The mobility of a rod is at most that of its free segments. So both together are a step of a projected gradient
// method with a safe metric, to which Nesterov's acceleration applies (APGD, Mazhar et al. 2015). Then all bodies move
// once. Joints open by second-order terms only, which the next Newton iteration closes. Linear momentum is kept to
// rounding, angular momentum to O(dtheta^2), the error of one rotation update.
//
// Multipliers of contacts that persist start from those of the last step. A converged result does not depend on them.
//
// Allocates only for more contacts than before, for the first contact of a rod, and in the broad phase.
#pragma once

#include "solver/contact/contact.hpp"
#include "solver/contact/contact_motion.hpp"
#include "solver/contact/coulomb_contact.hpp"

namespace rodsweep {

/// Relative to the smaller radius of two bodies; 0 without contacts.
struct ContactState {
  double penetration = 0;  ///< the deepest overlap
  double residual = 0;     ///< largest correction of a contact; converged if below the tolerance
};

class ContactProjection {
 public:
  /// Impulses are forces times unit_dt^2 (contact_motion.hpp).
  ContactProjection(Scene& scene, const ContactSettings& settings, double unit_dt);

  /// Call at p, with the time at the end of the step.
  void start_step(double end_s);

  /// Call at p*, or at another start of Newton's iteration: finds the contacts of the step. Returns false if p* is not
  /// finite. With `keeps_balance`, impulses of contacts that persist count in the balance of momentum from now on.
  bool find(bool keeps_balance);

  /// Call after the rods' projection. Returns whether the contacts had converged: then no body is moved.
  bool project();

  /// The rods that hit something between p and their present positions, those expected at the end of the step, and the
  /// rods near these, directly or through others, which the blow may reach in the step: a flag each. Bodies hit each other if they come nearer by more
  /// than a hundredth of a radius, touch, and did not press in the last step.
  const std::vector<char>& impacts();

  const std::vector<Contact>& contacts() const { return contacts_; }

  /// The residuals of the contacts in the current state, which is not changed. Sets the rods' contact impulses.
  ContactState state();

 private:
  /// A contact at the current positions.
  struct Linear {
    CoulombContact law;
    Vector3 arm_a, arm_b;  ///< from the centres to the common point
    double width;          ///< of the gap [m]
    Vector3 slip;          ///< of a's material against b's at the common point, since the start of the step
    double size;           ///< the smaller radius, the reference of motions
  };
  void linearise();
  bool press();
  double sweep();
  void undo_sweep();
  void tell_impulses();
  void restart(double moved);
  void accelerate(double moved);
  void push(const Contact& contact, const Linear& at, const Vector3& impulse);
  Vector3 slip(int body, const Vector3& point) const;

  Scene& scene_;
  ContactSettings settings_;
  double unit_dt_;
  ContactFinder finder_;
  ContactMotion motion_;
  std::vector<Contact> contacts_;
  std::vector<Contact> last_;  ///< of the last step
  bool fresh_ = false;         ///< not projected yet
  bool keeps_balance_ = false;
  std::vector<Linear> linear_;
  std::vector<CapsuleAxis> axes_;
  std::vector<char> hit_;  ///< impacts()
  struct OldPose {
    Vector3 position;
    Quaternion orientation;
  };
  std::vector<OldPose> old_;     ///< of every segment at p
  std::vector<Vector3> before_;  ///< impulses before the sweep
  std::vector<Vector3> swept_;   ///< impulses after the last sweep
  double momentum_ = 1;          ///< Nesterov's t
  double least_moved_ = 0;       ///< by a sweep since the last restart
};

}  // namespace rodsweep
