// Contacts within a time step, as complementarity with Coulomb friction (coulomb_contact.hpp), solved by projected
// Gauss-Seidel (Jean 1999) on accumulated multipliers (XPBD, Macklin et al. 2016), after the projection of the rods.
// Gaps are relative to the allowed gap (contact.hpp). A slip is h times the velocity at the end of the step. In an
// impact with restitution, the gap is h times the velocity of separation, relative to that of the rebound.
//
// In every Newton iteration the contacts are linearised at the current positions: normal, gap, and the nearest points of
// the two surfaces, at which equal and opposite impulses act. The points meet when the gap closes. (At a common point,
// friction would have too short an arm while bodies overlap, and a rod on a slope would turn too little.) Contacts that carry an impulse
// or would overlap are active, and only these are iterated, with the matrix of the motions of their points per impulse,
//
//   v = G lambda,   G = P H P^T   (Delassus; P: from motions of segments to those of points),
//
// H the mobility of the rods with their joints (contact_motion.hpp). G has a dense block for each rod. A sweep relaxes
// one contact after the other, from the first to the last and back: symmetric block Gauss-Seidel, a projected gradient
// method whose metric is at least G, to which Nesterov's acceleration applies (APGD, Mazhar et al. 2015). Then contacts
// that would overlap by the motion of the whole rods become active too, until there are none, and all bodies move once.
// Joints open by second-order terms only, which the next Newton iteration closes. Linear momentum is kept to rounding,
// angular momentum to O(dtheta^2), the error of one rotation update.
//
// Where a rod has no Delassus operator (contact_motion.hpp), G is that of free segments, and the joints respond after
// each sweep. Free segments move more than the rod, so the metric is safe as well; if no rod has one, sweeps go in one
// direction.
//
// Multipliers of contacts that persist start from those of the last step. A converged result does not depend on them.
//
// Allocates only for more contacts than before, for the first contact of a rod, and in the broad phase.
#pragma once

#include "solver/contact/contact.hpp"
#include "solver/contact/contact_motion.hpp"
#include "solver/contact/coulomb_contact.hpp"
#include "solver/rod/joint_forces.hpp"

namespace rodsweep {

/// Relative to the smaller radius of two bodies; 0 without contacts.
struct ContactState {
  double penetration = 0;  ///< the deepest overlap
  double residual = 0;     ///< largest correction of a contact; converged if below the tolerance
};

class ContactProjection {
 public:
  /// Impulses are forces times unit_dt^2 (contact_motion.hpp). `two_steps`: of BDF2 (rebound.hpp).
  /// The settings have a tolerance.
  ContactProjection(Scene& scene, const ContactSettings& settings, double unit_dt, bool two_steps);

  /// Call at p, with the time at the end of the step.
  void start_step(double end_s);

  /// To be set before find().
  PastPoses& past(std::size_t rod) { return motion_.past(rod); }

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

  /// Adds what obstacles and held segments exert on free segments, about the origin, in the step that state() ended.
  void add_actions(Action& of_obstacles, Action& of_clamps) const;

 private:
  /// A contact at the current positions.
  struct Linear {
    BodyPoint a, b;  ///< on the surfaces
    double width;    ///< of the gap [m]
    double gap;   ///< what must not be negative: the width over the allowed one, or a separation over the rebound [m]
    double size;  ///< the smaller radius, the reference of motions
    bool is_active;
  };
  /// A contact that is iterated, in its frame.
  struct Active {
    std::size_t contact;
    Matrix3 frame;
    CoulombContact law;
    double size;            ///< the reference of motions
    Vector3 start;          ///< gap and slip without v [m]
    Vector3 impulse;        ///< [kg m]
    Vector3 settled;        ///< the impulse that the bodies' motions have
    Vector3 before, swept;  ///< impulses before the last sweep, after the sweep before
    int a, b;               ///< its points, -1 if the body does not move
  };
  /// A point of an active contact, and its block column of G, in the contact's frame.
  struct Point {
    const BodyPoint* place;
    std::size_t active;  ///< its contact
    int group;           ///< ContactMotion::group
    std::size_t begin;   ///< of its group in motions_
    std::size_t rows;    ///< of its group, a multiple of eight
    std::size_t motion;  ///< the first of its three rows
    std::size_t column;  ///< the first of its three columns in coupling_, each with the rows of the group

    /// Of row r of another point's motion, by component c of an impulse here.
    std::size_t entry(const Point& of, int r, int c) const { return column + at(c) * rows + of.motion + at(r); }
  };
  void linearise();
  Point& point(int i) { return points_[at(i)]; }
  const Point& point(int i) const { return points_[at(i)]; }
  Vector3 motion(const Active& active) const;
  void push(int point, const Vector3& impulse);
  void place_points();
  using Velocity = Vector3 (ContactMotion::*)(const BodyPoint&) const;
  Vector3 slip(const Linear& at, Velocity velocity = &ContactMotion::velocity) const;
  double separation_short_of_rebound(std::size_t contact);
  double friction(const Contact& contact) const;
  double residual();
  bool activate();
  void couple();
  void press();
  void press_single(const Active& active);
  double sweep();
  double relax(Active& active);
  void change(Active& active, const Vector3& impulse);
  void settle();
  void find_motions();
  void restart(double moved);
  void accelerate(double moved);
  void tell_impulses();

  Scene& scene_;
  ContactSettings settings_;
  double tolerance_;
  double unit_dt_;
  bool two_steps_;
  ContactFinder finder_;
  ContactMotion motion_;
  std::vector<Contact> contacts_;
  std::vector<Contact> last_;  ///< of the last step
  bool fresh_ = false;         ///< not projected yet
  bool keeps_balance_ = false;
  std::vector<Linear> linear_;
  std::vector<CapsuleAxis> axes_;
  std::vector<char> hit_;  ///< impacts()
  std::vector<Active> active_;
  std::vector<Point> points_;
  std::vector<int> by_group_;    ///< points, sorted
  std::vector<Lane8> motions_;   ///< of the points, group after group
  std::vector<Lane8> coupling_;  ///< G of each group, by columns
  double momentum_ = 1;          ///< Nesterov's t
  double least_moved_ = 0;       ///< by a sweep since the last restart
};

}  // namespace rodsweep
