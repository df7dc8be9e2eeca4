#include "network/guess/state_network.hpp"

#include <limits>
#include <stdexcept>

#include "solver/numbers/rotation.hpp"

namespace rodsweep {

StateNetworkProjection::StateNetworkProjection(const Scene& scene, std::shared_ptr<const Model> model, double dt)
    : model_(std::move(model)), dt_(dt) {
  const CopingNetSettings& settings = model_->net.settings();
  if (is_guess(settings))
    throw std::invalid_argument("StateNetworkProjection: the model does not have the encoding state");
  for (const Rod& rod : scene.rods)
    rods_.push_back({StateEncoding(rod, scene.gravity_m_s2),
                     StateHistory(rod, dt),
                     Tensor<float>(node_features(settings), rod.segment_count()),
                     Tensor<float>(edge_features(settings), rod.joint_count()),
                     Tensor<float>(0, rod.joint_count()),
                     Tensor<float>(6, rod.segment_count()),
                     {}});
}

ProjectionReport StateNetworkProjection::project(Rod& rod, const SolvePosition& at, double, double) {
  ProjectionReport report{SolveOutcome::not_run, std::numeric_limits<double>::quiet_NaN()};
  if (at.newton > 0) return report;
  OfRod& of = rods_[static_cast<std::size_t>(at.rod)];
  of.history.start_step(rod.velocity, rod.angular_velocity);
  of.encoding.encode(rod, of.history, of.nodes, of.edges);
  model_->scales.nodes.apply(of.nodes);
  model_->scales.edges.apply(of.edges);
  model_->net.forward(of.encoding.topology(), of.nodes, of.edges, of.tape, of.y_edges, &of.y_nodes);
  of.y_nodes.array().colwise() *= model_->scales.moves.deviation;
  report.outcome = SolveOutcome::not_a_number;
  if (!of.y_nodes.allFinite()) return report;
  for (std::size_t s = 0; s < rod.segments.size(); ++s) {
    if (rod.segments[s].is_static) continue;
    const Vector6 answer = of.y_nodes.col(static_cast<Eigen::Index>(s)).cast<double>();
    const Quaternion& frame = of.history.orientation(s);
    const Motion& now = of.history.motion(s);
    const Vector3 velocity = now.velocity + frame * Vector3(answer.head<3>());
    const Vector3 spin = now.spin + frame * Vector3(answer.tail<3>());
    rod.position[s] = of.history.position(s) + dt_ * velocity;
    rod.orientation[s] = rotated(frame, dt_ * spin);
  }
  report.outcome = SolveOutcome::converged;
  return report;
}

}  // namespace rodsweep
