// What the moves of the paper's guess could be for. Its guess is a pair, moves and multipliers, and CG on A starts from
// multipliers alone. On the coupled system [M -J^T; J alpha~] the moves are eliminated exactly, M dp = J^T dlambda, so
// that CG on A, its Schur complement, forgets whatever they were. What is left is Newton: the pair may take the place
// of its first solve, and the constraints are linearised where the moves lead. Tried here on falling rods, with the
// network named on the command line (of the loss "mse" with moves; by default network/pretrained/bending-paper.h5):
//   from zero           CG from zero in every iteration
//   multipliers         at j = 0 CG from the network's multipliers
//   pair, its moves     at j = 0 the network's multipliers and moves instead of a solve, CG from zero after that
//   pair, M^-1 J^T      the same, with the moves that belong to its multipliers
//   free flight         at j = 0 nothing, which costs a Newton iteration: what a pair must beat
// A table of means over those of 20 rods that lasted 100 steps: Newton iterations to 1e-6 and CG iterations of a step,
// the distance from the trajectory of direct solves at the end in rod lengths, and how far momentum is out of balance,
// |M (x - x*) - J^T lambda| over |M (x - x*)|, which no later iteration of the paper's step looks at.
#include <cstdio>
#include <memory>
#include <string>

#include "network/guess/end_to_end.hpp"
#include "runner/training/model_file.hpp"
#include "solver/cg/conjugate_gradient.hpp"
#include "solver/cg/petsc_session.hpp"
#include "solver/numbers/split_mix.hpp"
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
    if (asks && !network_.predict(rod, system_, at, dt_c, x_, moves_)) return {SolveOutcome::not_a_number};
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

  /// Of the step that has ended.
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
