// For tests of steps: one step of a scene, the reports of its projections, a free body, and the distance of two scenes.
#pragma once

#include <algorithm>
#include <vector>

#include "solver/step/time_step.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test {

/// Calls another projection and keeps its reports.
class Recorder : public Projection {
 public:
  explicit Recorder(Projection& inner) : inner_(inner) {}
  ProjectionReport project(Rod& rod, const SolvePosition& at, double dt, double newton_tolerance) override {
    positions.push_back(at);
    reports.push_back(inner_.project(rod, at, dt, newton_tolerance));
    return reports.back();
  }
  std::vector<double> residuals() const {
    std::vector<double> out;
    for (const ProjectionReport& report : reports) out.push_back(report.newton_residual);
    return out;
  }
  std::vector<SolvePosition> positions;
  std::vector<ProjectionReport> reports;

 private:
  Projection& inner_;
};

/// One free cylinder without gravity.
inline Scene free_body() {
  const SegmentSpec s{{0.3, -0.2, 0.5}, Quaternion(0.4, 0.1, -0.7, 0.3).normalized(), 0.4, 0.1, 800, false};
  Scene scene = scene_of(Rod({s}, {}));
  scene.gravity_m_s2.setZero();
  return scene;
}

/// The scene after one step with direct solves; Newton iterates to rounding.
inline Scene after_newton(Scene scene, double dt) {
  DirectSolve direct(scene);
  LinearProjection projection(scene, direct);
  TimeStepper(scene, {dt, 40, 1e-15}).step(projection);
  return scene;
}

/// The scene after one step of a Gauss-Seidel projection with at most `iterations` iterations.
template <class GaussSeidel, class... Settings>
Scene after(Scene scene, double dt, int iterations, const Settings&... settings) {
  GaussSeidel projection(scene, settings...);
  TimeStepper(scene, {dt, iterations, 1e-15}).step(projection);
  return scene;
}

/// The largest difference between vectors of two scenes; `of` is a member such as &Rod::position.
inline double distance(const Scene& one, const Scene& other, std::vector<Vector3> Rod::*of) {
  double most = 0;
  for (std::size_t r = 0; r < one.rods.size(); ++r)
    for (std::size_t s = 0; s < one.rods[r].segments.size(); ++s)
      most = std::max(most, ((one.rods[r].*of)[s] - (other.rods[r].*of)[s]).norm());
  return most;
}

}  // namespace rodsweep::test
