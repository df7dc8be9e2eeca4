// Quality and cost of preconditioners on cubic lattices in motion: IC with levels of fill, PETSc's algebraic
// multigrids, and the learned incomplete factors of network/pretrained/lattices.h5 (or a model from the command line),
// which can represent IC(0). Spectra of P^-1 A are converged extreme Ritz values of CG from zero on a random right-hand
// side (Lanczos; Golub & Van Loan 2013, section 11.3). Iterations are to ||b - A x||_2 = 1e-2 and 1e-4 ||b||_2 with the
// lattice's own b. Times are minima of several runs, per joint.
#include <Eigen/Eigenvalues>
#include <cstdio>
#include <functional>
#include <memory>
#include <string>

#include "network/encoding/feature_encoder.hpp"
#include "network/processor/coupled_inference.hpp"
#include "runner/file/provenance.hpp"
#include "runner/training/model_file.hpp"
#include "solver/cg/block_preconditioner.hpp"
#include "solver/cg/petsc_session.hpp"
#include "solver/numbers/counter_random.hpp"
#include "solver/scene/scenes.hpp"
#include "solver/step/stopwatch.hpp"
#include "solver/step/time_step.hpp"
#include "tests/bench/multigrid.hpp"

namespace {

using namespace rodsweep;
using bench::Multigrid;

constexpr double dt = 0.02;
constexpr int steps = 12, nodes = 8, most_iterations = 2000, lanczos_steps = 300, repeats = 5;

struct Case {
  Scene scene;
  std::unique_ptr<LinearSystem> system;

  explicit Case(double youngs_modulus_pa) {
    Lattice lattice;
    lattice.nodes_x = nodes;
    lattice.radius_m = 0.01;
    lattice.youngs_modulus_pa = youngs_modulus_pa;
    lattice.torsion_modulus_pa = 4e5;
    lattice.gravity_m_s2 = {3, -8, 5};
    scene = build_scene(lattice);
    DirectSolve direct(scene);
    LinearProjection projection(scene, direct);
    TimeStepper stepper(scene, {dt, 2, 0});
    for (int step = 0; step < steps; ++step) stepper.step(projection);
    system = std::make_unique<LinearSystem>(scene.rods.front());
    system->assemble(scene.rods.front(), dt);
  }
};

/// A preconditioner: its set-up and z = P^-1 r.
struct Way {
  std::string name;
  std::function<bool()> set_up;
  std::function<void(const VectorX&, VectorX&)> apply;
};

struct Run {
  Eigen::VectorXd diagonal, beside;  ///< of the tridiagonal matrix
  int iterations = 0;
  bool converged = false;
};

/// Conjugate gradients from zero until the residual is below `tolerance`, or `most` iterations.
Run conjugate_gradients(const LinearSystem& system, const Way& way, const VectorX& b, double tolerance, int most) {
  VectorX r = b, z(b.size()), p(b.size()), ap(b.size());
  Run run;
  run.diagonal.setZero(most);
  run.beside.setZero(most);
  way.apply(r, z);
  p = z;
  double rz = r.dot(z), alpha_before = 1, beta_before = 0;
  for (int k = 0; k < most; ++k) {
    system.multiply(p.data(), ap.data());
    const double alpha = rz / p.dot(ap);
    r -= alpha * ap;
    run.diagonal[k] = 1 / alpha + beta_before / alpha_before;
    run.iterations = k + 1;
    run.converged = r.norm() <= tolerance * b.norm();
    if (run.converged) return run;
    way.apply(r, z);
    const double rz_next = r.dot(z), beta = rz_next / rz;
    run.beside[k] = std::sqrt(beta) / alpha;
    p = z + beta * p;
    rz = rz_next;
    alpha_before = alpha;
    beta_before = beta;
  }
  return run;
}

double least_s(const std::function<void()>& what) {
  double least = 1e9;
  for (int k = 0; k < repeats; ++k) {
    const Stopwatch watch;
    what();
    least = std::min(least, watch.seconds());
  }
  return least;
}

void print(const Case& of, const Way& way) {
  const LinearSystem& system = *of.system;
  const double joints = of.scene.rods.front().joint_count();
  if (!way.set_up()) {
    std::printf("%-22s not positive definite\n", way.name.c_str());
    return;
  }
  SplitMix random(1);
  VectorX noise(system.rhs().size()), z(noise.size());
  for (double& entry : noise) entry = 2 * random.uniform() - 1;
  const Run lanczos = conjugate_gradients(system, way, noise, 1e-10, lanczos_steps);
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> ritz;
  ritz.computeFromTridiagonal(lanczos.diagonal.head(lanczos.iterations), lanczos.beside.head(lanczos.iterations - 1),
                              Eigen::EigenvaluesOnly);
  const Eigen::VectorXd& values = ritz.eigenvalues();
  const double least = values[0], most = values[values.size() - 1];
  const auto to = [&](double tolerance) {
    const Run run = conjugate_gradients(system, way, system.rhs(), tolerance, most_iterations);
    return run.converged ? std::to_string(run.iterations) : "never";
  };
  std::printf("%-22s %9.2g %10.2g %9.3g %9s %9s %11.0f %10.0f\n", way.name.c_str(), least, most, most / least,
              to(1e-2).c_str(), to(1e-4).c_str(), 1e9 / joints * least_s([&] { way.set_up(); }),
              1e9 / joints * least_s([&] { way.apply(noise, z); }));
}

Way jacobi(const LinearSystem& system) {
  const auto inverse = std::make_shared<VectorX>(system.rhs().size());
  return {"jacobi",
          [inverse, &system] {
            const BlockMatrix& a = system.matrix();
            for (int row = 0; row < a.block_rows(); ++row)
              for (int k = 0; k < 6; ++k)
                (*inverse)[6 * row + k] = 1 / a.blocks[static_cast<std::size_t>(a.diagonal(row))].column[k][k];
            return true;
          },
          [inverse](const VectorX& r, VectorX& z) { z = inverse->cwiseProduct(r); }};
}

Way incomplete(const LinearSystem& system, int levels) {
  const std::shared_ptr<BlockPreconditioner> own =
      block_preconditioner(Preconditioner::block_icc, system.matrix(), levels);
  return {"block_icc, " + std::to_string(levels) + " levels", [own, &system] { return own->set_up(system.matrix()); },
          [own](const VectorX& r, VectorX& z) { own->apply(r.data(), z.data()); }};
}

/// The learned factors as a guess uses them (network/guess/coping_net_correction.hpp).
class LearnedFactors {
 public:
  LearnedFactors(const Model& model, const Rod& rod, const LinearSystem& system)
      : rod_(rod),
        system_(system),
        encoder_(model.net.settings(), rod, system.matrix()),
        inference_(model.net.coupled(), model.net.parameters(), encoder_.pattern()),
        nodes_(node_features(model.net.settings()), rod.segment_count()),
        edges_(edge_features(model.net.settings()), rod.joint_count()),
        zero_(VectorX::Zero(system.rhs().size())) {}

  void set_up() {
    encoder_.encode(rod_, system_, 0, zero_, system_.rhs(), nodes_, edges_);
    inference_.factorise(encoder_.system()->frames(), system_.matrix());
  }
  void apply(const VectorX& r, VectorX& z) { inference_.solve(r, z); }

 private:
  const Rod& rod_;
  const LinearSystem& system_;
  FeatureEncoder encoder_;
  CoupledInference inference_;
  Tensor<float> nodes_, edges_;
  VectorX zero_;
};

template <class Solver>
Way way_of(const char* name, const std::shared_ptr<Solver>& solver) {
  return {name,
          [solver] {
            solver->set_up();
            return true;
          },
          [solver](const VectorX& r, VectorX& z) { solver->apply(r, z); }};
}

}  // namespace

int main(int argc, char** argv) {
  const PetscSession petsc;
  const StoredModel stored = read_model(argc > 1 ? argv[1] : RODSWEEP_SOURCE_DIR "/network/pretrained/lattices.h5");
  std::printf("revision %s; %s\n", source_revision().c_str(), library_versions().c_str());
  for (const double youngs_modulus_pa : {3e5, 1e6, 1e7}) {
    const Case of(youngs_modulus_pa);
    const Rod& rod = of.scene.rods.front();
    std::printf("\ncubic lattice, %d^3 nodes, %d joints, E = %.0e Pa, step %d\n", nodes, rod.joint_count(),
                youngs_modulus_pa, steps);
    std::printf("%-22s %9s %10s %9s %9s %9s %11s %10s\n", "", "least", "greatest", "ratio", "to 1e-2", "to 1e-4",
                "set-up ns", "apply ns");
    print(of, jacobi(*of.system));
    for (const int levels : {0, 1, 3}) print(of, incomplete(*of.system, levels));
    print(of, way_of("gamg", std::make_shared<Multigrid>(Multigrid::Kind::gamg, rod, *of.system)));
    print(of, way_of("boomeramg", std::make_shared<Multigrid>(Multigrid::Kind::boomer, rod, *of.system)));
    print(of, way_of("learned", std::make_shared<LearnedFactors>(*stored.model, rod, *of.system)));
  }
}
