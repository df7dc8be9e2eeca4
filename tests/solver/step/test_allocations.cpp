// After its first steps, a time step allocates nothing: not in our code, Eigen or PETSc.
#include <cstdlib>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "solver/cg/conjugate_gradient.hpp"
#include "solver/factor/condensed_factor.hpp"
#include "solver/guess/extrapolation_guess.hpp"
#include "solver/guess/initial_guess.hpp"
#include "solver/guess/oracle_guess.hpp"
#include "solver/guess/regression_guess.hpp"
#include "solver/guess/ritz_guess.hpp"
#include "solver/guess/subspace_guess.hpp"
#include "solver/guess/wrapped_guess.hpp"
#include "solver/numbers/rotation.hpp"
#include "solver/step/gauss_seidel.hpp"
#include "solver/step/time_step.hpp"
#include "tests/catch.hpp"
#include "tests/solver/allocations.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_allocations {

/// CG from a guess, with its history recorded, as in paired evaluation and closed loops.
class CgSolve : public LinearSolve {
 public:
  CgSolve(const CgSettings& settings, std::unique_ptr<InitialGuess> guess)
      : settings_(settings), guess_(std::move(guess)) {}
  SolveOutcome solve(const LinearSystem& system, const SolvePosition& at, double, VectorX& delta_lambda) override {
    if (!cg_) {
      cg_ = std::make_unique<ConjugateGradient>(system.matrix(), settings_);
      cg_->keep_history(true);
    }
    cg_->matrix_changed();
    guess_->prepare(at);
    const bool nonzero = guess_->propose(system, at, delta_lambda).nonzero;
    const CgReport report =
        cg_->solve(system.rhs(), delta_lambda, nonzero, 1e-6, cg_->norm_of(system.rhs()), guess_->deflation());
    guess_->accept(system, at, delta_lambda);
    return report.outcome;
  }

 private:
  CgSettings settings_;
  std::unique_ptr<InitialGuess> guess_;
  std::unique_ptr<ConjugateGradient> cg_;
};

/// Allocations in ten steps after the first five.
long allocations_of(Scene& scene, Projection& projection) {
  TimeStepper stepper(scene, {0.02, 4, 1e-9});
  long before = 0;
  for (int step = 0; step < 15; ++step) {
    if (step == 5) before = test::allocations();
    const StepReport report = stepper.step(projection);
    if (report.outcome != SolveOutcome::converged) return -1;
  }
  return test::allocations() - before;
}

long allocations_of(Scene& scene, LinearSolve& solve) {
  LinearProjection projection(scene, solve);
  return allocations_of(scene, projection);
}

Scene loaded_scene() {
  BendingRod spec = test::bending_rod(12);
  spec.tip_force_n = {0, 1, 1};
  spec.damping_per_s = 0.1;
  WindParameters wind;
  wind.turbulence_m_s = 1;
  spec.wind = wind;
  Scene scene = build_scene(spec);
  const Pose start{scene.rods[0].position[0], scene.rods[0].orientation[0]};
  scene.clamps.push_back({0, 0, [start](double t) {
                            return Pose{start.position + Vector3(0, 0, 0.1 * t), start.orientation};
                          }});
  return scene;
}

TEST_CASE("the count sees new, malloc, calloc, realloc and aligned memory") {
  void* volatile p = nullptr;
  const double* volatile seen = nullptr;  // a compiler may leave out memory that nothing sees
  const std::function<void()> allocate[] = {[&] { p = std::malloc(100); },
                                            [&] { p = std::realloc(p, 100000); },
                                            [&] { std::free(p), p = std::calloc(3, 100); },
                                            [&] { std::free(p), p = std::aligned_alloc(64, 128); },
                                            [&] { seen = std::vector<double>(100).data(); },
                                            [&] { seen = VectorX(100).data(); }};
  for (const auto& call : allocate) {
    const long before = test::allocations();
    call();
    CHECK(test::allocations() > before);
  }
  std::free(p);
}

TEST_CASE("the count sees PETSc") {
  const Scene scene = loaded_scene();
  LinearSystem system(scene.rods[0]);
  const long before = test::allocations();
  const ConjugateGradient cg(system.matrix(), {});
  CHECK(test::allocations() - before > 10);  // one is ours, the others are PETSc's
}

TEST_CASE("a direct step allocates nothing, in the balance of momentum too, nor does one by Gauss-Seidel") {
  Scene scene = loaded_scene();
  DirectSolve direct(scene);
  CHECK(allocations_of(scene, direct) == 0);
  LinearProjection balanced(scene, direct, 1e-6);
  CHECK(allocations_of(scene, balanced) == 0);
  XpbdProjection xpbd(scene);
  CHECK(allocations_of(scene, xpbd) == 0);
  PbdProjection pbd(scene, {0.9, 0.5});
  CHECK(allocations_of(scene, pbd) == 0);
}

TEST_CASE("a step of a lattice, whose matrix is factorised in fronts or condensed, allocates nothing") {
  for (const Stretch stretch : {Stretch::inextensible, Stretch::physical}) {
    Lattice p = test::lattice_of(Lattice::Cell::cubic, 5);
    p.stretch = stretch;
    Scene scene = build_scene(p);
    DirectSolve direct(scene);
    const Rod& rod = scene.rods[0];
    REQUIRE(DirectFactor(rod).condenses() == (stretch == Stretch::physical));
    REQUIRE(BlockFactor(LinearSystem(rod).matrix(), root_to_leaf_order(rod)).has_fronts());
    CHECK(allocations_of(scene, direct) == 0);
    LinearProjection balanced(scene, direct, 1e-6);
    CHECK(allocations_of(scene, balanced) == 0);
  }
}

TEST_CASE("a step with contacts allocates nothing unless there are more of them or the broad phase searches anew") {
  Scene scene = build_scene(test::bending_rod(12, Clamp::free));
  for (Vector3& position : scene.rods[0].position) position.y() = 0.05;
  for (Quaternion& orientation : scene.rods[0].orientation)
    orientation = turn_between(Vector3::UnitZ(), Vector3::UnitX());
  scene.contact = ContactSettings{};
  scene.obstacles = {HalfSpace{}, Ball{{0, -9, 0}, 8.9}};
  DirectSolve direct(scene);
  CHECK(allocations_of(scene, direct) == 0);
}

TEST_CASE("contacts allocate once, in the first step in which there are so many") {
  const bool has_delassus_operator = GENERATE(true, false);
  BendingRod spec = test::bending_rod(12, Clamp::free);
  spec.stretch_compliance_per_j = has_delassus_operator ? 1e-6 : 1e-12;
  Scene scene = build_scene(spec);
  for (std::size_t s = 0; s < 12; ++s) {
    scene.rods[0].position[s] = {static_cast<double>(s) / 6, 0.05, 0};
    scene.rods[0].orientation[s] = turn_between(Vector3::UnitZ(), Vector3::UnitX());
  }
  REQUIRE(can_be_condensed(scene.rods[0]) == has_delassus_operator);
  scene.contact = ContactSettings{};
  scene.obstacles = {HalfSpace{}};
  DirectSolve direct(scene);
  LinearProjection projection(scene, direct);
  TimeStepper stepper(scene, {0.02, 4, 1e-9});
  const int most = stepper.step(projection).contacts;
  CHECK(most > 0);
  const long before = test::allocations();
  for (int step = 0; step < 3; ++step) CHECK(stepper.step(projection).contacts <= most);
  CHECK(test::allocations() == before);
}

TEST_CASE("a step with CG allocates nothing, whatever the guess") {
  Scene scene = loaded_scene();
  const auto previous = [&] { return std::make_unique<ExtrapolationGuess>(scene, 4, 1); };
  const auto regression = [&] { return std::make_unique<RegressionGuess>(scene, 4, 5, 1e-2); };
  const auto subspace = [&](SubspaceGuess::Window window, SubspaceGuess::Use use = SubspaceGuess::Use::guess) {
    return std::make_unique<SubspaceGuess>(scene, 4, 5, window, use);
  };
  std::map<std::string, std::unique_ptr<InitialGuess>> guesses;
  guesses["zero"] = std::make_unique<ZeroGuess>();
  guesses["quadratic"] = std::make_unique<ExtrapolationGuess>(scene, 4, 3);
  guesses["oracle"] = std::make_unique<OracleGuess>(scene, 0.1, OracleGuess::Error::smooth, 7);
  guesses["fischer"] = subspace(SubspaceGuess::Window::restarted);
  guesses["subspace"] = subspace(SubspaceGuess::Window::sliding);
  guesses["deflation"] = subspace(SubspaceGuess::Window::sliding, SubspaceGuess::Use::guess_and_deflation);
  guesses["guarded"] = std::make_unique<GuardedGuess>(scene, previous(), 0.5);
  guesses["ritz"] = std::make_unique<RitzGuess>(scene, previous(), 5, 8, 1000);
  guesses["totals"] = std::make_unique<TotalsGuess>(scene, regression());
  for (auto& [name, guess] : guesses) {
    INFO(name);
    Scene moving = scene;
    CgSolve solve({}, std::move(guess));
    CHECK(allocations_of(moving, solve) == 0);
  }
}

TEST_CASE("a step with CG allocates nothing, whatever the norm and the preconditioner but PETSc's factor") {
  for (const Norm norm : {Norm::true_residual, Norm::natural})
    for (const Preconditioner p : {Preconditioner::none, Preconditioner::jacobi, Preconditioner::point_block_jacobi,
                                   Preconditioner::block_icc, Preconditioner::cholesky}) {
      INFO("preconditioner " << static_cast<int>(p) << ", norm " << static_cast<int>(norm));
      Scene scene = loaded_scene();
      CgSolve solve({p, norm, 0}, std::make_unique<ZeroGuess>());
      CHECK(allocations_of(scene, solve) == 0);
    }
}

}  // namespace rodsweep::test_allocations
