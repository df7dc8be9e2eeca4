#include "runner/dataset/stored_systems.hpp"

#include <cmath>
#include <utility>

#include "runner/file/state_rows.hpp"
#include "solver/numbers/narrow.hpp"

namespace rodsweep {

SystemRows::SystemRows(const Scene& scene, int iterations) : iterations_(iterations) {
  for (const Rod& rod : scene.rods) {
    rods_.push_back(iteration_);
    ++iteration_.system;
    iteration_.segment += rod.segments.size();
    iteration_.joint += rod.joints.size();
  }
}

SystemRows::Place SystemRows::place(const SolvePosition& at) const {
  const std::size_t before =
      static_cast<std::size_t>(at.step) * static_cast<std::size_t>(iterations_) + static_cast<std::size_t>(at.newton);
  const Place& rod = rods_[static_cast<std::size_t>(at.rod)];
  return {before * iteration_.system + rod.system, before * iteration_.segment + rod.segment,
          before * iteration_.joint + rod.joint};
}

void SystemStore::before(const Rod& rod, const SolvePosition& at, bool balanced) {
  const SystemRows::Place place = rows_.place(at);
  record_.system_step[place.system] = at.step;
  record_.system_newton[place.system] = static_cast<std::int16_t>(at.newton);
  record_.system_rod[place.system] = narrow<std::int16_t>(at.rod);
  store(rod.position, record_.system_position_m.data() + 3 * place.segment);
  store(rod.orientation, record_.system_orientation.data() + 4 * place.segment);
  store(rod.velocity, record_.system_velocity_m_s.data() + 3 * place.segment);
  store(rod.angular_velocity, record_.system_angular_velocity_rad_s.data() + 3 * place.segment);
  VectorX::Map(record_.system_lambda.data() + 6 * place.joint, rod.lambda.size()) = rod.lambda;
  if (!balanced) return;
  store(rod.free_position, record_.system_free_position_m.data() + 3 * place.segment);
  store(rod.free_orientation, record_.system_free_orientation.data() + 4 * place.segment);
  for (std::size_t s = 0; s < rod.segments.size(); ++s) {
    const Vector6 impulse = rod.contact_impulse.empty() ? Vector6::Zero() : rod.contact_impulse[s];
    const std::size_t row = 3 * (place.segment + s);
    Vector3::Map(record_.system_contact_force.data() + row) = impulse.head<3>();
    Vector3::Map(record_.system_contact_torque.data() + row) = impulse.tail<3>();
  }
}

namespace {

std::optional<StoredBalance> stored_balance(const TaskRecord& record, const Rod& rod, std::size_t first) {
  const std::vector<double>& position = record.system_free_position_m;
  if (position.empty() || std::isnan(position[3 * first])) return std::nullopt;
  StoredBalance out;
  out.free_position.resize(rod.segments.size());
  out.free_orientation.resize(rod.segments.size());
  load(position.data() + 3 * first, out.free_position);
  load(record.system_free_orientation.data() + 4 * first, out.free_orientation);
  for (std::size_t row = 3 * first; row < 3 * (first + rod.segments.size()); row += 3)
    out.contact_impulse.emplace_back() << Vector3::Map(record.system_contact_force.data() + row),
        Vector3::Map(record.system_contact_torque.data() + row);
  return out;
}

}  // namespace

StoringSolve::StoringSolve(const Scene& scene, int iterations, LinearSolve& solve, TaskRecord& record)
    : scene_(scene), store_(scene, iterations, record), solve_(solve) {}

SolveOutcome StoringSolve::solve(const LinearSystem& system, const SolvePosition& at, double assemble_s,
                                 VectorX& delta_lambda) {
  if (!store_.holds(at)) return solve_.solve(system, at, assemble_s, delta_lambda);
  store_.before(scene_.rods[static_cast<std::size_t>(at.rod)], at, system.keeps_balance());
  const SolveOutcome outcome = solve_.solve(system, at, assemble_s, delta_lambda);
  if (outcome == SolveOutcome::converged) VectorX::Map(store_.solution(at), delta_lambda.size()) = delta_lambda;
  return outcome;
}

std::vector<StoredSystem> stored_systems(const TaskRecord& record, const Scene& scene, int iterations) {
  const SystemRows rows(scene, iterations);
  std::vector<StoredSystem> systems;
  for (std::size_t row = 0; row < record.system_step.size(); ++row) {
    if (record.system_step[row] < 0) continue;
    StoredSystem system;
    system.at = {record.system_step[row], record.system_newton[row], record.system_rod[row]};
    const Rod& rod = scene.rods[static_cast<std::size_t>(system.at.rod)];
    const SystemRows::Place place = rows.place(system.at);
    system.position.resize(rod.segments.size());
    system.orientation.resize(rod.segments.size());
    system.velocity.resize(rod.segments.size());
    system.angular_velocity.resize(rod.segments.size());
    load(record.system_position_m.data() + 3 * place.segment, system.position);
    load(record.system_orientation.data() + 4 * place.segment, system.orientation);
    load(record.system_velocity_m_s.data() + 3 * place.segment, system.velocity);
    load(record.system_angular_velocity_rad_s.data() + 3 * place.segment, system.angular_velocity);
    system.balance = stored_balance(record, rod, place.segment);
    system.lambda = VectorX::Map(record.system_lambda.data() + 6 * place.joint, rod.lambda.size());
    system.solution = VectorX::Map(record.system_solution.data() + 6 * place.joint, rod.lambda.size());
    systems.push_back(std::move(system));
  }
  return systems;
}

}  // namespace rodsweep
