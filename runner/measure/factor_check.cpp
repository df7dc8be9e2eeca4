#include "runner/measure/factor_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <tuple>
#include <vector>

#include "solver/factor/block_factor.hpp"
#include "solver/linear/linear_system.hpp"

namespace rodsweep {
namespace {

bool is_oracle(const GuessSpec& guess) { return find_guess<guess::Oracle>(guess) != nullptr; }

/// The key that makes a task factorise, and the alternative; null if it does not factorise.
struct Need {
  const char *for_what, *instead;
};
Need need(const TaskSpec& spec) {
  if (spec.solve.is_direct())
    return {"solve", "a smaller scene, or method \"cg\" with \"reference\": \"cg\" (no factorisation)"};
  if (rod_parameters(spec.scene).contact) return {"scene.contact", "a smaller scene, or one without contact"};
  if (std::any_of(spec.guesses.begin(), spec.guesses.end(), is_oracle))
    return {"guesses", "a smaller scene, or no \"oracle\""};
  return {nullptr, nullptr};
}

/// Whether a factor with all 6 x 6 blocks of its lower triangle might be too large.
bool may_be_too_large(std::int64_t joints, double most_bytes) {
  const auto n = static_cast<double>(joints);
  return sizeof(double) * 36 * n * n / 2 > most_bytes / 2;  // fronts are padded
}

/// Throws JobError if the joints of one segment are too many: each is coupled to each, in the matrix and in its factor.
void check_couplings(const Rod& rod, const Task& task, const Job& job, double most_bytes) {
  std::vector<int> joints(rod.segments.size());
  for (const Joint& joint : rod.joints)
    for (const int segment : {joint.a, joint.b})
      if (!rod.segments[static_cast<std::size_t>(segment)].is_static) ++joints[static_cast<std::size_t>(segment)];
  const double most = *std::max_element(joints.begin(), joints.end());
  constexpr double gibibyte = 1 << 30;
  if (const double bytes = sizeof(double) * 36 * most * most; bytes > most_bytes)
    throw job_error(
        job.path, "scene",
        fmt::format("task {}: {} joints on one segment need {:.3g} GiB, because each is coupled to each; must "
                    "be at most {:.3g} GiB: hold the point where they meet, or let fewer meet there",
                    task.index, most, bytes / gibibyte, most_bytes / gibibyte));
}

}  // namespace

void check_factors(const Plan& plan, double most_bytes) {
  std::set<std::tuple<std::size_t, std::int64_t, std::int64_t, bool>> seen;
  for (const Task& task : plan.tasks()) {
    if (!may_be_too_large(task.joints, most_bytes)) continue;
    const TaskSpec spec = plan.spec(task.index);
    const Need factor = need(spec);
    const bool loops = task.joints > task.segments - rod_count(spec.scene), factorises = loops && factor.for_what;
    if (is_gauss_seidel(spec.solve.method) ||
        !seen.emplace(spec.scene.index(), task.segments, task.joints, factorises).second)
      continue;
    for (const Rod& rod : build_scene(spec.scene).rods) {
      if (!may_be_too_large(rod.joint_count(), most_bytes)) continue;
      check_couplings(rod, task, plan.job(), most_bytes);
      if (!factorises) continue;
      try {
        refuse_too_large(plan_elimination(LinearSystem(rod).matrix(), root_to_leaf_order(rod)), most_bytes);
      } catch (const FactorTooLarge& error) {
        throw job_error(plan.job().path, factor.for_what,
                        fmt::format("task {}: {}; must be {}", task.index, error.what(), factor.instead));
      }
    }
  }
}

}  // namespace rodsweep
