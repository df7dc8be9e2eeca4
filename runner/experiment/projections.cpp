#include "runner/experiment/projections.hpp"

#include "runner/experiment/recorded_increments.hpp"
#include "runner/experiment/recorded_iterations.hpp"
#include "solver/step/xpbd_projection.hpp"

namespace rodsweep {

std::unique_ptr<Projection> make_projection(const Scene& scene, const TaskSpec& spec, TaskRecord& record,
                                            LinearSolve& solve) {
  switch (spec.solve.method) {
    case Method::direct:
    case Method::cg: break;
    case Method::end_to_end:
      return std::make_unique<EndToEndProjection>(scene, std::make_unique<RecordedIncrements>(scene, spec, record));
    case Method::pbd:
      return std::make_unique<RecordedIterations>(scene, spec, record,
                                                  std::make_unique<PbdProjection>(scene, spec.solve.stiffness));
    case Method::xpbd:
      return std::make_unique<RecordedIterations>(scene, spec, record, std::make_unique<XpbdProjection>(scene));
  }
  return std::make_unique<LinearProjection>(scene, solve);
}

const char* projection_failed(Method method) {
  if (is_gauss_seidel(method)) return "Gauss-Seidel ended as ";
  return method == Method::end_to_end ? "the network's answer is " : "the linear solve ended as ";
}

}  // namespace rodsweep
