#include "network/encoding/stored_simulation.hpp"

#include <stdexcept>
#include <string>

#include "solver/rod/momentum_balance.hpp"

namespace rodsweep {

void restore(const StoredSystem& system, Rod& rod) {
  if (system.position.size() != rod.segments.size() || system.lambda.size() != rod.lambda.size())
    throw std::invalid_argument("restore: the system has " + std::to_string(system.position.size()) + " segments and " +
                                std::to_string(system.lambda.size() / 6) + " joints, the rod has " +
                                std::to_string(rod.segment_count()) + " and " + std::to_string(rod.joint_count()));
  rod.position = system.position;
  rod.orientation = system.orientation;
  rod.velocity = system.velocity;
  rod.angular_velocity = system.angular_velocity;
  rod.lambda = system.lambda;
  rod.constraint_dt = system.constraint_dt_s;
  unstiffen(rod);
  if (!system.balance) return;
  rod.free_position = system.balance->free_position;
  rod.free_orientation = system.balance->free_orientation;
  rod.contact_impulse = system.balance->contact_impulse;
}

void assemble_again(const StoredSystem& stored, Rod& rod, LinearSystem& system) {
  restore(stored, rod);
  if (stored.balance)
    system.assemble_balanced(rod, rod.constraint_dt);
  else
    system.assemble(rod, rod.constraint_dt);
}

Replay::Replay(const StoredSimulation& simulation) : simulation_(simulation), scene_(simulation.scene) {
  for (const Rod& rod : scene_.rods) systems_.emplace_back(rod);
}

}  // namespace rodsweep
