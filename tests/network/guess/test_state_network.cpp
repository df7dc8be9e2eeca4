// A simulator that updates states: its history, its features of turned scenes, the effect of its output on rods.

#include "network/guess/state_network.hpp"
#include "network/training/example_builder.hpp"
#include "network/training/trainer.hpp"
#include "solver/step/time_step.hpp"
#include "tests/catch.hpp"
#include "tests/network/models.hpp"
#include "tests/network/stored.hpp"
#include "tests/solver/turned.hpp"

namespace rodsweep::test_state_network {

using namespace test;

CopingNetSettings of_states() { return message_passing(Encoding::state, true); }

/// A model with random weights and outputs small enough to keep rods intact.
std::shared_ptr<Model> small_answers() {
  auto model = random_model(of_states());
  model->scales.moves.deviation *= 0.01F;
  return model;
}

std::vector<const StoredSystem*> first_of_steps(const StoredSimulation& simulation) {
  std::vector<const StoredSystem*> out;
  for (const StoredSystem& stored : simulation.systems)
    if (stored.at.newton == 0) out.push_back(&stored);
  return out;
}

TEST_CASE("the velocities of a recorded simulation give back where it went") {
  const StoredSimulation simulation = stored_simulation(sample_scene(2), 12);
  Simulation direct(simulation.scene, {simulation.step_s, simulation.newton_iterations, 0});
  StateHistory history(direct.rod(), simulation.step_s);
  for (const StoredSystem* stored : first_of_steps(simulation)) {
    history.start_step(stored->velocity, stored->angular_velocity);
    for (std::size_t s = 0; s < stored->velocity.size(); ++s) {
      CHECK((history.position(s) - direct.rod().position[s]).norm() < 1e-13);
      CHECK(history.orientation(s).angularDistance(direct.rod().orientation[s]) < 1e-7);
    }
    direct.step();
  }
}

TEST_CASE("examples hold what leads to the next velocities, whatever the noise in their history") {
  const StoredSimulation simulation = stored_simulation(sample_scene(2), 8);
  std::vector<Example> examples;
  add_examples(of_states(), simulation, examples, {2, 0.3, 7});
  REQUIRE(examples.size() == 3 * 7);
  const std::vector<const StoredSystem*> steps = first_of_steps(simulation);
  for (std::size_t i = 0; i < examples.size(); ++i) {
    const Example& example = examples[i];
    const std::size_t n = i / 3;
    CHECK(example.edge_target.rows() == 0);
    for (Eigen::Index s = 0; s < example.nodes.cols(); ++s) {
      // The length of a vector is the same in every frame.
      const Eigen::Vector3f next = example.nodes.col(s).head<3>() + example.node_target.col(s).head<3>();
      const Vector3& recorded = steps[n + 1]->velocity[s];
      if (s > 0) CHECK(next.norm() == Approx(recorded.norm()).margin(1e-5));
      if (s == 0) CHECK(example.node_target.col(s).isZero());
    }
    CHECK((example.nodes.topRows(3) == examples[3 * n].nodes.topRows(3)) == (i % 3 == 0));
  }
}

TEST_CASE("an answer that is exact gives the recorded trajectory") {
  const StoredSimulation simulation = stored_simulation(sample_scene(1), 6);
  const Rod& rod = simulation.scene.rods.front();
  StateHistory history(rod, simulation.step_s);
  Tensor<float> answer(6, rod.segment_count());
  const std::vector<const StoredSystem*> steps = first_of_steps(simulation);
  for (std::size_t n = 0; n + 1 < steps.size(); ++n) {
    history.start_step(steps[n]->velocity, steps[n]->angular_velocity);
    StateEncoding::answer(rod, history, steps[n + 1]->velocity, steps[n + 1]->angular_velocity, answer);
    for (std::size_t s = 1; s < rod.segments.size(); ++s) {
      const Vector6 local = answer.col(static_cast<Eigen::Index>(s)).cast<double>();
      const Vector3 velocity = history.motion(s).velocity + history.orientation(s) * Vector3(local.head<3>());
      const Vector3 spin = history.motion(s).spin + history.orientation(s) * Vector3(local.tail<3>());
      CHECK((velocity - steps[n + 1]->velocity[s]).norm() < 1e-5);
      CHECK((spin - steps[n + 1]->angular_velocity[s]).norm() < 1e-5);
    }
  }
}

TEST_CASE("noise is a random walk: it grows from the first velocity to the last, and moves the rod with it") {
  const StoredSimulation simulation = stored_simulation(build_scene(bending_rod(40)), 7);
  const Rod& rod = simulation.scene.rods.front();
  StateHistory history(rod, simulation.step_s);
  for (const StoredSystem* stored : first_of_steps(simulation))
    history.start_step(stored->velocity, stored->angular_velocity);
  SplitMix random(3);
  constexpr double noise = 0.01;
  std::array<double, StateHistory::length> square{};
  constexpr int times = 40;
  for (int i = 0; i < times; ++i) {
    const StateHistory disturbed = history.disturbed(rod, noise, 0.1, random);
    CHECK(disturbed.motion(0).velocity == history.motion(0).velocity);
    for (std::size_t s = 1; s < 40; ++s) {
      Vector3 moved = Vector3::Zero();
      for (std::size_t ago = 0; ago < StateHistory::length; ++ago) {
        const Vector3 by = disturbed.motion(s, ago).velocity - history.motion(s, ago).velocity;
        square[ago] += by.squaredNorm() / (3 * 39 * times);
        moved += simulation.step_s * by;
      }
      CHECK((disturbed.position(s) - history.position(s) - moved).norm() < 1e-12);
    }
  }
  for (std::size_t ago = 0; ago < StateHistory::length; ++ago)
    CHECK(square[ago] == Approx(noise * noise * static_cast<double>(StateHistory::length - ago) / 5).epsilon(0.1));
}

TEST_CASE("a simulator sees no turn of the whole scene, and turned rods move as turned") {
  const Scene start = sample_scene(2);
  const RigidMotion motion{Quaternion(Eigen::AngleAxisd(1.2, Vector3(1, 2, -1).normalized())), {3, -1, 2}};
  Scene here = start, there = moved(start, motion);
  const auto model = small_answers();
  StateNetworkProjection one(here, model, 0.02), other(there, model, 0.02);
  TimeStepper stepper(here, {0.02, 2, 1e-9}), stepper_there(there, {0.02, 2, 1e-9});
  for (int step = 0; step < 10; ++step) {
    REQUIRE(stepper.step(one).outcome == SolveOutcome::converged);
    REQUIRE(stepper_there.step(other).outcome == SolveOutcome::converged);
  }
  double moved = 0;
  for (std::size_t s = 0; s < here.rods[0].segments.size(); ++s) {
    CHECK((there.rods[0].position[s] - motion(here.rods[0].position[s])).norm() < 1e-4);
    moved = std::max(moved, (here.rods[0].position[s] - start.rods[0].position[s]).norm());
  }
  CHECK(moved > 1e-3);
}

TEST_CASE("rolled features are those of frames that are rolled") {
  const Rod rod = sample_scene(1).rods.front();
  const double angle = 0.7;
  const Vector3 gravity(1, -9, 2);
  const std::vector<Vector3> v(rod.segments.size(), {0.1, 0.2, 0.3}), w(rod.segments.size(), {0.5, -0.2, 0.1});
  const auto encoded = [&](const Rod& of) {
    StateHistory history(of, 0.02);
    history.start_step(v, w);
    std::pair<Tensor<float>, Tensor<float>> out{Tensor<float>(37, of.segment_count()),
                                                Tensor<float>(15, of.joint_count())};
    StateEncoding(of, gravity).encode(of, history, out.first, out.second);
    return out;
  };
  auto plain = encoded(rod);
  const auto expected = encoded(rolled(rod, angle));
  roll(StateEncoding::node_groups(), angle, plain.first);
  roll(StateEncoding::edge_groups(), angle, plain.second);
  CHECK(plain.first.isApprox(expected.first, 1e-5F));
  CHECK((plain.second - expected.second).norm() < 1e-4F);
}

TEST_CASE("a simulator that says nothing keeps every free segment in its motion") {
  Scene scene = sample_scene(0);
  auto model = random_model(of_states());
  for (float& weight : model->net.parameters().values()) weight = 0;
  StateNetworkProjection projection(scene, model, 0.02);
  for (Vector3& v : scene.rods[0].velocity) v = {1, 0, 0};
  const Scene start = scene;
  TimeStepper stepper(scene, {0.02, 3, 1e-9});
  for (int step = 0; step < 5; ++step) CHECK(stepper.step(projection).newton_iterations == 1);
  CHECK(scene.rods[0].position[0] == start.rods[0].position[0]);
  for (std::size_t s = 1; s < scene.rods[0].segments.size(); ++s)
    CHECK((scene.rods[0].position[s] - start.rods[0].position[s] - Vector3(0.1, 0, 0)).norm() < 1e-12);
}

TEST_CASE("an output that is not finite leaves the rod unchanged; other models are refused") {
  Scene scene = sample_scene(0);
  auto model = random_model(of_states());
  model->scales.moves.deviation[0] = std::numeric_limits<float>::infinity();
  StateNetworkProjection projection(scene, model, 0.02);
  Rod rod = scene.rods.front();
  CHECK(projection.project(rod, {0, 0, 0}, 0.02, 0).outcome == SolveOutcome::not_a_number);
  CHECK(rod.position[1] == scene.rods[0].position[1]);
  CHECK_THROWS_AS(StateNetworkProjection(scene, random_model(message_passing(Encoding::paper_residual, true)), 0.02),
                  std::invalid_argument);
}

}  // namespace rodsweep::test_state_network
