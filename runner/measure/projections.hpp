// Constructs the projection that moves the rods in each iteration of a step, by the task's solve.method.
#pragma once

#include <memory>

#include "runner/file/record.hpp"
#include "runner/specs/task_spec.hpp"
#include "solver/step/projection.hpp"

namespace rodsweep {

/// `solve` is used by the methods "direct" and "cg". All arguments must outlive the projection.
std::unique_ptr<Projection> make_projection(const Scene& scene, const TaskSpec& spec, TaskRecord& record,
                                            LinearSolve& solve);

/// The text before an outcome in messages: "the linear solve ended as ".
const char* projection_failed(Method method);

}  // namespace rodsweep
