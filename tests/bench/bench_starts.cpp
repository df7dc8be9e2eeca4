// What no start can give (docs/limits.md). Each part gives a method for nothing what no guess has:
//
//   exact start      the solution of every system: what remains of a whole step bounds what a guess can save
//   neighbours       the solutions of the same step in the two neighbouring simulations of a sweep, as two more vectors
//                    of the basis on which `subspace` projects
//   Newton's start   the converged state of the step, apart from a share of today's error
//   contacts' start  the impulses of the same step: each step is taken, undone and taken again, so that "those of the
//                    last step" are its own
//
// Trajectories are those of direct solves. Times are processor time of all steps but the first, medians of five runs.
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "runner/file/provenance.hpp"
#include "solver/cg/conjugate_gradient.hpp"
#include "solver/cg/petsc_session.hpp"
#include "solver/step/time_step.hpp"
#include "tests/bench/contact_scenes.hpp"

namespace {

using namespace rodsweep;

double processor_s() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

template <class Value>
double median_of_five(const Value& value) {
  std::array<double, 5> values;
  for (double& one : values) one = value();
  std::sort(values.begin(), values.end());
  return values[2];
}

// ---- scenes ----

BendingRod bending_rod() {
  BendingRod rod;
  rod.segments = 50;
  rod.damping_per_s = 2;
  return rod;
}

Helix helix() {
  Helix helix;
  helix.segments = 70;
  helix.youngs_modulus_pa = 1e6;
  helix.torsion_modulus_pa = 2e5;
  helix.damping_per_s = 2;
  return helix;
}

Net net(int crossings) {
  Net net;
  net.rows = net.columns = crossings;
  net.radius_m = 0.01;
  net.youngs_modulus_pa = 1e7;
  net.torsion_modulus_pa = 4e6;
  net.damping_per_s = 1;
  return net;
}

Lattice lattice(int nodes) {
  Lattice lattice;
  lattice.nodes_x = nodes;
  lattice.segments = 2;
  lattice.held = Held::side;
  lattice.radius_m = 0.01;
  lattice.youngs_modulus_pa = 1e7;
  lattice.torsion_modulus_pa = 4e6;
  lattice.damping_per_s = 1;
  return lattice;
}

// ---- exact start ----

/// Gives the solutions of an earlier run, if there was one; else solves directly and keeps them.
class Known : public LinearSolve {
 public:
  Known(const Scene& scene, std::vector<VectorX>& solutions)
      : direct_(scene), solutions_(solutions), known_(!solutions.empty()) {}
  SolveOutcome solve(const LinearSystem& system, const SolvePosition& at, double assemble_s, VectorX& x) override {
    if (known_) {
      x = solutions_[next_++];
      return SolveOutcome::converged;
    }
    const SolveOutcome outcome = direct_.solve(system, at, assemble_s, x);
    solutions_.push_back(x);
    return outcome;
  }

 private:
  DirectSolve direct_;
  std::vector<VectorX>& solutions_;
  bool known_;
  std::size_t next_ = 0;
};

/// CG from zero to 1e-2.
class Iterative : public LinearSolve {
 public:
  explicit Iterative(Preconditioner preconditioner) : settings_{preconditioner, Norm::true_residual, 0} {}
  SolveOutcome solve(const LinearSystem& system, const SolvePosition&, double, VectorX& x) override {
    if (!cg_) cg_.emplace(system, settings_);
    cg_->matrix_changed();
    return cg_->solve(system.rhs(), x, {false}, 1e-2, cg_->norm_of(system.rhs())).outcome;
  }

 private:
  CgSettings settings_;
  std::optional<ConjugateGradient> cg_;
};

/// Of 59 steps, with the solve that `make` makes for a scene.
template <class Make>
double time_of_steps(const SceneSpec& spec, const Make& make) {
  Scene scene = build_scene(spec);
  auto solve = make(scene);
  LinearProjection projection(scene, solve);
  TimeStepper stepper(scene, {0.01, 2, 0, Integrator::bdf2});
  stepper.step(projection);
  const double start = processor_s();
  for (int step = 1; step < 60; ++step) stepper.step(projection);
  return processor_s() - start;
}

void print_exact_start() {
  std::printf("Exact start: time of a whole step over that of one whose solutions are known\n");
  std::printf("%-16s %10s %10s %10s\n", "scene", "direct", "block_icc", "jacobi");
  const std::pair<const char*, SceneSpec> scenes[]{{"bending rod", bending_rod()}, {"helix", helix()},
                                                   {"net 8 x 8", net(8)},          {"net 32 x 32", net(32)},
                                                   {"lattice 4^3", lattice(4)},    {"lattice 8^3", lattice(8)}};
  for (const auto& [name, spec] : scenes) {
    std::vector<VectorX> solutions;
    const auto known = [&](const Scene& scene) { return Known(scene, solutions); };
    time_of_steps(spec, known);
    const double free = median_of_five([&, &spec = spec] { return time_of_steps(spec, known); });
    const auto over_free = [&, &spec = spec](const auto& make) {
      return median_of_five([&] { return time_of_steps(spec, make); }) / free;
    };
    std::printf("%-16s %10.2f %10.2f %10.2f\n", name, over_free([](const Scene& scene) { return DirectSolve(scene); }),
                over_free([](const Scene&) { return Iterative(Preconditioner::block_icc); }),
                over_free([](const Scene&) { return Iterative(Preconditioner::jacobi); }));
  }
}

// ---- neighbours ----

/// Solves directly; before that, CG from projections on the last ten solutions, and on the last eight and the
/// neighbours' two, counts iterations.
class Compared : public LinearSolve {
 public:
  Compared(const Scene& scene, Preconditioner preconditioner, const std::vector<VectorX>& low,
           const std::vector<VectorX>& high)
      : direct_(scene), settings_{preconditioner, Norm::true_residual, 0}, low_(low), high_(high) {}

  SolveOutcome solve(const LinearSystem& system, const SolvePosition& at, double assemble_s, VectorX& x) override {
    std::vector<const VectorX*> own, with_neighbours{&low_[next_], &high_[next_]};
    ++next_;
    for (const VectorX& one : last_) {
      own.push_back(&one);
      if (with_neighbours.size() < 10) with_neighbours.push_back(&one);
    }
    if (last_.size() == 10) {
      subspace += iterations(system, own);
      neighbours += iterations(system, with_neighbours);
    }
    const SolveOutcome outcome = direct_.solve(system, at, assemble_s, x);
    last_.push_front(x);
    if (last_.size() > 10) last_.pop_back();
    return outcome;
  }

  long subspace = 0, neighbours = 0;

 private:
  int iterations(const LinearSystem& system, const std::vector<const VectorX*>& basis) {
    const auto n = static_cast<Eigen::Index>(basis.size());
    Eigen::MatrixXd v(system.rhs().size(), n), product(v.rows(), n);
    for (Eigen::Index k = 0; k < n; ++k) {
      v.col(k) = *basis[static_cast<std::size_t>(k)];
      system.matrix().multiply(v.col(k).data(), product.col(k).data());
    }
    VectorX x = v * (v.transpose() * product).completeOrthogonalDecomposition().solve(v.transpose() * system.rhs());
    if (!cg_) cg_.emplace(system.matrix(), settings_);
    cg_->matrix_changed();
    return cg_->solve(system.rhs(), x, {true}, 1e-4, cg_->norm_of(system.rhs())).iterations;
  }

  DirectSolve direct_;
  CgSettings settings_;
  std::optional<ConjugateGradient> cg_;
  const std::vector<VectorX>&low_, &high_;
  std::size_t next_ = 0;
  std::deque<VectorX> last_;
};

/// 100 steps.
void run_steps(Scene& scene, LinearSolve& solve) {
  LinearProjection projection(scene, solve);
  TimeStepper stepper(scene, {0.01, 2, 0, Integrator::bdf2});
  for (int step = 0; step < 100; ++step) stepper.step(projection);
}

template <class Spec>
void print_neighbours(const char* name, Preconditioner preconditioner, const Spec& spec) {
  for (const int varied : {1, 3}) {
    std::printf("%-28s", (std::string(name) + (varied > 1 ? ", three values" : ", one value")).c_str());
    for (const double spacing : {0.001, 0.01, 0.05, 0.2}) {
      std::array<std::vector<VectorX>, 2> solutions;
      const auto moved = [&, varied = varied](double by) {
        Spec made = spec;
        made.youngs_modulus_pa *= 1 + by;
        if (varied == 3) {
          made.torsion_modulus_pa *= 1 - by;
          made.radius_m *= 1 + by;
        }
        return made;
      };
      for (const std::size_t side : {0u, 1u}) {
        Scene scene = build_scene(moved(side ? spacing : -spacing));
        Known recorded(scene, solutions[side]);
        run_steps(scene, recorded);
      }
      Scene scene = build_scene(spec);
      Compared compared(scene, preconditioner, solutions[0], solutions[1]);
      run_steps(scene, compared);
      std::printf(" %9.2f", static_cast<double>(compared.neighbours) / static_cast<double>(compared.subspace));
    }
    std::printf("\n");
  }
}

// ---- Newton's start ----

/// Moves the rod towards the converged state of the step before its first iteration.
class Started : public Projection {
 public:
  Started(const Scene& scene, double share) : direct_(scene), projection_(scene, direct_), share_(share) {}

  ProjectionReport project(Rod& rod, const SolvePosition& at, double dt_c, double tolerance) override {
    if (at.newton == 0 && share_ < 1) {
      Rod exact = rod;
      for (int i = 0;
           i < 30 && projection_.project(exact, {at.step, i, at.rod}, dt_c, 1e-13).outcome == SolveOutcome::converged;)
        ++i;
      for (std::size_t s = 0; s < rod.position.size(); ++s) {
        rod.position[s] = exact.position[s] + share_ * (rod.position[s] - exact.position[s]);
        rod.orientation[s] = exact.orientation[s].slerp(share_, rod.orientation[s]);
      }
      rod.lambda = exact.lambda + share_ * (rod.lambda - exact.lambda);
    }
    return projection_.project(rod, at, dt_c, tolerance);
  }

 private:
  DirectSolve direct_;
  LinearProjection projection_;
  double share_;
};

void print_newton(const char* name, const SceneSpec& spec, Integrator integrator, double dt) {
  for (const double tolerance : {1e-3, 1e-9}) {
    const char* const of = integrator == Integrator::euler ? "Euler" : "BDF2";
    char row[64];
    std::snprintf(row, sizeof row, "%s, %s %.0f ms, to %.0e", name, of, 1e3 * dt, tolerance);
    std::printf("%-34s", row);
    for (const double share : {1.0, 0.1, 0.01, 0.0}) {
      Scene scene = build_scene(spec);
      Started projection(scene, share);
      TimeStepper stepper(scene, {dt, 30, tolerance, integrator});
      double iterations = 0;
      for (int step = 0; step < 100; ++step) iterations += stepper.step(projection).newton_iterations / 100.0;
      std::printf(" %8.2f", iterations);
    }
    std::printf("\n");
  }
}

// ---- contacts' start ----

void print_contacts(const char* name, const SceneSpec& spec, double dt, int steps) {
  double usual = 0, exact = 0, of_usual = 0, of_exact = 0;
  Scene scene = build_scene(spec);
  DirectSolve direct(scene);
  LinearProjection projection(scene, direct);
  TimeStepper stepper(scene, {dt, 30, 1e-9});
  for (int step = 0; step < steps; ++step) {
    const std::vector<Rod> before = scene.rods;
    double start = processor_s();
    of_usual += stepper.step(projection).newton_iterations;
    usual += processor_s() - start;
    scene.rods = before;
    start = processor_s();
    of_exact += stepper.step(projection).newton_iterations;
    exact += processor_s() - start;
  }
  std::printf("%-14s %14.1f %10.1f %10.2f\n", name, of_usual / steps, of_exact / steps, usual / exact);
}

}  // namespace

int main() {
  const PetscSession petsc;
  std::printf("revision %s; %s\n\n", source_revision().c_str(), library_versions().c_str());
  print_exact_start();

  std::printf("\nNeighbours: CG iterations to 1e-4 from a projection with their solutions, over those without\n");
  std::printf("%-28s %9s %9s %9s %9s\n", "spacing of the sweep", "0.1 %", "1 %", "5 %", "20 %");
  print_neighbours("bending rod", Preconditioner::jacobi, bending_rod());
  print_neighbours("helix", Preconditioner::jacobi, helix());
  print_neighbours("net 16 x 16", Preconditioner::block_icc, net(16));

  std::printf("\nNewton's start: iterations a step to a tolerance, from a share of today's error\n");
  std::printf("%-34s %8s %8s %8s %8s\n", "share of the error", "1", "0.1", "0.01", "0");
  for (const auto& [integrator, dt] : {std::pair{Integrator::euler, 0.02}, std::pair{Integrator::bdf2, 0.01}}) {
    print_newton("bending rod", bending_rod(), integrator, dt);
    print_newton("helix", helix(), integrator, dt);
  }

  std::printf(
      "\nContacts' start: Newton iterations a step, and time of the usual step over that from exact impulses\n");
  std::printf("%-14s %14s %10s %10s\n", "scene", "usual", "exact", "time");
  auto falling = touching<FallingRods>(0.02, 1e7, 1e6);
  falling.rods = 6;
  print_contacts("falling rods", falling, 0.005, 200);
  auto heap = falling;
  heap.rods = 30;
  print_contacts("heap of 30", heap, 0.005, 200);
  print_contacts("octet lattice", dropped_octet_lattice(), 0.004, 150);
}
