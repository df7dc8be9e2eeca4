// Scenes for laws: at least one of each type that a job may have, with the files that they name.
#pragma once

#include <vector>

#include "runner/plan/plan.hpp"
#include "tests/runner/job_folder.hpp"

namespace rodsweep::scene_samples {

constexpr double step_s = 0.01;

/// As jobs have them: with what is asymmetric in them, and with contacts that begin within some steps.
std::vector<Json> samples();

class SceneFiles {
 public:
  SceneFiles() {
    folder_.write("fork.swc", "1 1 0 0 0 3 -1\n2 1 0 30 5 3 1\n3 1 10 60 5 2 2\n4 1 -20 50 0 2 2\n");
    folder_.write("fork.csv", "0 0 0\n30 5 0\n60 0 5\n\n30 5 0\n40 30 -20\n");
  }
  /// `changes`: merged into the job.
  Job job(const Json& scene, const Json& changes = Json::object()) const {
    Json job = {{"name", "law"},
                {"kind", "sweep"},
                {"evaluation", "closed_loop"},
                {"scene", scene},
                {"time", {{"step_s", step_s}, {"steps", 1}}},
                {"solve", {{"method", "direct"}}}};
    job.merge_patch(changes);
    return folder_.job(job);
  }
  Scene scene(const Json& scene) const { return build_scene(Plan(job(scene)).spec(0).scene); }

 private:
  JobFolder folder_;
};

}  // namespace rodsweep::scene_samples
