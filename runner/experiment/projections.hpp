// What moves the rods of a task in every iteration of a step, by its solve.method.
#pragma once

#include <memory>

#include "runner/file/record.hpp"
#include "runner/job/task.hpp"
#include "solver/step/projection.hpp"

namespace rodsweep {

/// `solve` solves the linear systems of the methods that have any. All arguments must outlive the projection.
std::unique_ptr<Projection> make_projection(const Scene& scene, const TaskSpec& spec, TaskRecord& record,
                                            LinearSolve& solve);

/// "the linear solve ended as ", to go before an outcome.
const char* projection_failed(Method method);

}  // namespace rodsweep
