#include "runner/dataset/stored_systems.hpp"

#include <cmath>
#include <utility>

#include "solver/numbers/narrow.hpp"
#include "solver/rod/rod_arrays.hpp"

namespace rodsweep {

SystemRows::SystemRows(const Scene& scene, int iterations) : iterations_(iterations) {
  for (const Rod& rod : scene.rods) {
    rods_.push_back(iteration_);
    ++iteration_.system;
    iteration_.segment += rod.segments.size();
    iteration_.joint += rod.joints.size();
  }
}

SystemRows::First SystemRows::first_of(const SolvePosition& at) const {
  const std::size_t before =
      static_cast<std::size_t>(at.step) * static_cast<std::size_t>(iterations_) + static_cast<std::size_t>(at.newton);
  const First& rod = rods_[static_cast<std::size_t>(at.rod)];
  return {before * iteration_.system + rod.system, before * iteration_.segment + rod.segment,
          before * iteration_.joint + rod.joint};
}

void StoringSolve::write_state(const Rod& rod, const SolvePosition& at, bool balanced) {
  const SystemRows::First first = rows_.first_of(at);
  record_.systems.step[first.system] = at.step;
  record_.systems.newton[first.system] = static_cast<std::int16_t>(at.newton);
  record_.systems.rod[first.system] = narrow<std::int16_t>(at.rod);
  record_.systems.constraint_dt_s[first.system] = rod.constraint_dt;
  store(rod.position, record_.systems.position_m.row(first.segment));
  store(rod.orientation, record_.systems.orientation.row(first.segment));
  store(rod.velocity, record_.systems.velocity_m_s.row(first.segment));
  store(rod.angular_velocity, record_.systems.angular_velocity_rad_s.row(first.segment));
  VectorX::Map(record_.systems.lambda.row(first.joint), rod.lambda.size()) = rod.lambda;
  if (!balanced) return;
  store(rod.free_position, record_.systems.free_position_m.row(first.segment));
  store(rod.free_orientation, record_.systems.free_orientation.row(first.segment));
  for (std::size_t s = 0; s < rod.segments.size(); ++s) {
    const Vector6 impulse = rod.outer_impulse(s);
    Vector3::Map(record_.systems.contact_force.row(first.segment + s)) = impulse.head<3>();
    Vector3::Map(record_.systems.contact_torque.row(first.segment + s)) = impulse.tail<3>();
  }
}

SolveOutcome StoringSolve::solve(const LinearSystem& system, const SolvePosition& at, double assemble_s,
                                 VectorX& delta_lambda) {
  if (!rows_.holds(at)) return solve_.solve(system, at, assemble_s, delta_lambda);
  write_state(scene_.rods[static_cast<std::size_t>(at.rod)], at, system.keeps_balance());
  const SolveOutcome outcome = solve_.solve(system, at, assemble_s, delta_lambda);
  if (outcome == SolveOutcome::converged)
    VectorX::Map(record_.systems.solution.row(rows_.first_of(at).joint), delta_lambda.size()) = delta_lambda;
  return outcome;
}

namespace {

std::optional<StoredBalance> stored_balance(const TaskRecord& record, const Rod& rod, std::size_t first) {
  const Cells<double>& position = record.systems.free_position_m;
  if (position.empty() || std::isnan(position(first))) return std::nullopt;
  StoredBalance out;
  load(position.row(first), rod.segments.size(), out.free_position);
  load(record.systems.free_orientation.row(first), rod.segments.size(), out.free_orientation);
  for (std::size_t row = first; row < first + rod.segments.size(); ++row)
    out.contact_impulse.emplace_back() << Vector3::Map(record.systems.contact_force.row(row)),
        Vector3::Map(record.systems.contact_torque.row(row));
  return out;
}

}  // namespace

std::vector<StoredSystem> stored_systems(const TaskRecord& record, const Scene& scene, int iterations) {
  const SystemRows rows(scene, iterations);
  std::vector<StoredSystem> systems;
  for (std::size_t row = 0; row < record.systems.step.size(); ++row) {
    if (record.systems.step[row] < 0) continue;
    StoredSystem system;
    system.at = {record.systems.step[row], record.systems.newton[row], record.systems.rod[row]};
    system.constraint_dt_s = record.systems.constraint_dt_s[row];
    const Rod& rod = scene.rods[static_cast<std::size_t>(system.at.rod)];
    const SystemRows::First first = rows.first_of(system.at);
    const std::size_t count = rod.segments.size();
    load(record.systems.position_m.row(first.segment), count, system.position);
    load(record.systems.orientation.row(first.segment), count, system.orientation);
    load(record.systems.velocity_m_s.row(first.segment), count, system.velocity);
    load(record.systems.angular_velocity_rad_s.row(first.segment), count, system.angular_velocity);
    system.balance = stored_balance(record, rod, first.segment);
    system.lambda = VectorX::Map(record.systems.lambda.row(first.joint), rod.lambda.size());
    system.solution = VectorX::Map(record.systems.solution.row(first.joint), rod.lambda.size());
    systems.push_back(std::move(system));
  }
  return systems;
}

}  // namespace rodsweep
