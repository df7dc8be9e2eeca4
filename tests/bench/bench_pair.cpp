// The use of the moves in the paper's guess. The guess is a pair of moves and multipliers, but CG on A starts from
// multipliers only. The moves are eliminated exactly from the coupled system [M -J^T; J alpha~], M dp = J^T dlambda, so
// CG on its Schur complement A ignores them. Newton can use the pair instead of its first solve, and linearise the
// constraints at the moved rod. Cases, on falling rods with a network of the loss "mse" with moves from the command
// line (default: network/pretrained/bending-paper.h5):
//   from zero           CG from zero in every iteration
//   multipliers         at j = 0 CG from the network's multipliers
//   pair, its moves     at j = 0 the network's multipliers and moves without a solve, then CG from zero
//   pair, M^-1 J^T      the same, with the moves M^-1 J^T of its multipliers
//   free flight         nothing at j = 0, at the cost of a Newton iteration: the minimum for a pair to beat
// Prints means over those of 20 rods that lasted 100 steps: Newton iterations to 1e-6 and CG iterations per step, the
// final distance from the trajectory of direct solves in rod lengths, and the imbalance of momentum
// |M (x - x*) - J^T lambda| / |M (x - x*)|, which later iterations of the paper's step ignore.
#include <cstdio>
#include <memory>
#include <string>

#include "network/guess/end_to_end.hpp"
#include "runner/file/provenance.hpp"
#include "runner/training/model_file.hpp"
#include "solver/cg/conjugate_gradient.hpp"
#include "solver/cg/petsc_session.hpp"
#include "solver/numbers/counter_random.hpp"
#include "solver/scene/scenes.hpp"
#include "solver/step/observables.hpp"
#include "solver/step/time_step.hpp"

namespace {

using namespace rodsweep;

constexpr double dt = 0.02, cg_tolerance = 1e-4, newton_tolerance = 1e-6;
constexpr int rods = 20, steps = 100, most_newton = 12;

enum class First { zero, multipliers, moves, consistent_moves, nothing };

class PairProjection : public Projection {
 public:
  PairProjection(const Scene& scene, const std::shared_ptr<const Model>& model, First first)
      : first_(first),
        system_(scene.rods.front()),
        cg_(system_.matrix(), {Preconditioner::jacobi, Norm::true_residual, 0}),
        network_(model, scene, most_newton),
        x_(VectorX::Zero(system_.rhs().size())) {}

  ProjectionReport project(Rod& rod, const SolvePosition& at, double dt_c, double tolerance) override {
    system_.assemble(rod, dt_c);
    ProjectionReport report{SolveOutcome::not_run, system_.newton_residual()};
    if (report.newton_residual < tolerance) return report;
    report.outcome = SolveOutcome::converged;
    if (at.newton == 0 && first_ == First::nothing) return report;
    const bool asks = at.newton == 0 && first_ != First::zero;
    if (asks && !network_.predict(rod, system_, at, x_, moves_)) return {SolveOutcome::not_a_number};
    if (asks && first_ != First::multipliers) {
      if (first_ == First::consistent_moves) system_.displacements(rod, x_, moves_);
      displace(rod, moves_, x_);
      return report;
    }
    cg_.matrix_changed();
    const CgReport solved = cg_.solve(system_.rhs(), x_, {asks}, cg_tolerance, cg_.norm_of(system_.rhs()));
    iterations += solved.iterations;
    report.outcome = solved.outcome;
    system_.apply(rod, x_);
    return report;
  }

  /// The imbalance of momentum after a step.
  double imbalance(const Rod& rod) {
    system_.displacements(rod, rod.lambda, moves_);
    double lacks = 0, all = 0;
    for (std::size_t s = 0; s < rod.segments.size(); ++s) {
      if (rod.segments[s].is_static) continue;
      const Vector3 moved = rod.position[s] - rod.free_position[s];
      const Vector3 by = rod.orientation[s] * Vector3(moves_[s][0], moves_[s][1], moves_[s][2]);
      lacks += (moved - by).squaredNorm();
      all += moved.squaredNorm();
    }
    return std::sqrt(lacks / all);
  }

  long iterations = 0;

 private:
  First first_;
  LinearSystem system_;
  ConjugateGradient cg_;
  CopingNetIncrements network_;
  VectorX x_;
  std::vector<Lane8> moves_;
};

Scene scene_of(int number) {
  SplitMix random(static_cast<std::uint64_t>(7000 + number));
  BendingRod rod;
  rod.segments = 10 + static_cast<int>(46 * random.uniform());
  rod.length_m = 1 + 4 * random.uniform();
  rod.youngs_modulus_pa = std::pow(10, 4 + 2 * random.uniform());
  rod.initial_angle_deg = 45 * random.uniform();
  return build_scene(rod);
}

struct Means {
  double newton = 0, cg = 0, distance = 0, imbalance = 0;
  int failed = 0;
};

Means run(const std::shared_ptr<const Model>& model, First first) {
  Means out;
  for (int r = 0; r < rods; ++r) {
    Scene scene = scene_of(r), reference = scene;
    PairProjection projection(scene, model, first);
    DirectSolve direct(reference);
    LinearProjection exact(reference, direct);
    const StepSettings settings{dt, most_newton, newton_tolerance};
    TimeStepper stepper(scene, settings), other(reference, settings);
    bool failed = false;
    double newton = 0, imbalance = 0;
    for (int step = 0; step < steps && !failed; ++step) {
      const StepReport report = stepper.step(projection);
      other.step(exact);
      newton += report.newton_iterations;
      imbalance += projection.imbalance(scene.rods[0]);
      failed = report.outcome != SolveOutcome::converged || joint_gap(scene.rods[0]) > 1;
    }
    out.failed += failed;
    if (failed) continue;
    out.newton += newton / steps;
    out.imbalance += imbalance / steps;
    double square = 0, length = 0;
    for (std::size_t s = 0; s < scene.rods[0].segments.size(); ++s) {
      square += (scene.rods[0].position[s] - reference.rods[0].position[s]).squaredNorm();
      length += scene.rods[0].segments[s].length_m;
    }
    out.distance += std::sqrt(square / scene.rods[0].segment_count()) / length;
    out.cg += static_cast<double>(projection.iterations) / steps;
  }
  for (double* const mean : {&out.newton, &out.cg, &out.distance, &out.imbalance}) *mean /= rods - out.failed;
  return out;
}

}  // namespace

int main(int argc, char** argv) {
  const PetscSession petsc;
  const std::string path = argc > 1 ? argv[1] : RODSWEEP_SOURCE_DIR "/network/pretrained/bending-paper.h5";
  const auto model = read_model(path).model;
  std::printf("revision %s; %s\n", source_revision().c_str(), library_versions().c_str());
  std::printf("%d rods, %d steps, %s\n\n", rods, steps, path.substr(path.rfind('/') + 1).c_str());
  std::printf("%-18s %10s %10s %12s %12s %8s\n", "at j = 0", "Newton", "CG", "distance / L", "imbalance", "failed");
  const std::pair<const char*, First> ways[]{{"from zero", First::zero},
                                             {"multipliers", First::multipliers},
                                             {"pair, its moves", First::moves},
                                             {"pair, M^-1 J^T", First::consistent_moves},
                                             {"free flight", First::nothing}};
  for (const auto& [name, first] : ways) {
    const Means means = run(model, first);
    std::printf("%-18s %10.2f %10.1f %12.2e %12.2e %8d\n", name, means.newton, means.cg, means.distance,
                means.imbalance, means.failed);
  }
}
