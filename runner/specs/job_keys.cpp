#include "runner/keys/key.hpp"

#include "runner/specs/scene_keys.hpp"
#include "runner/specs/solve_keys.hpp"
#include "runner/specs/training_job.hpp"

namespace rodsweep {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* no_guesses = "only a sweep tries guesses: remove this key";

Key record() {
  return object_key(
             "record", "what is written",
             {
                 choice_key("solves", "a row for every solve, or only sums for every task", {"all", "summary"})
                     .defaults_to("all")
                     .setting(),
                 choice_key(
                     "norms",
                     "count iterations in both norms, only in solve.norm (faster), or not at all, for times alone",
                     {"both", "one", "none"})
                     .defaults_to("both")
                     .only({"sweep"}, no_guesses)
                     .setting(),
                 choice_key("systems",
                            "linear systems that are stored, with rods, multipliers and solution: those of the first "
                            "Newton iteration of every step, or all",
                            {"first", "all"})
                     .defaults_to("first")
                     .only({"dataset"}, "use a job of kind \"dataset\"")
                     .setting(),
                 integer_key("trajectory_every", "steps from one frame of all segments to the next; 0: no frames")
                     .from(0, 10000000)
                     .defaults_to(0)
                     .setting(),
                 boolean_key("states", "in frames: velocities and what else a simulation needs to start from them")
                     .defaults_to(false)
                     .setting(),
                 boolean_key("forces",
                             "forces and moments of joints in frames, and those of clamps and obstacles in steps")
                     .defaults_to(false)
                     .setting(),
             })
      .defaults_to(Json::object())
      .setting();
}

std::vector<Key> keys_of_all() {
  return {
      text_key("name", "name of the job and of its results file").at_most(100).of_form(Key::Text::file_name).setting(),
      text_key("description", "comment for readers")
          .defaults_to("")
          .also_called({"comment", "//", "_comment", "note", "#"})
          .setting(),
      choice_key("kind", "kind of job", {"sweep", "dataset", "train"}).setting(),
      integer_key("seed", "seed of all random values").from(0, 9007199254740991).defaults_to(0).setting(),
      text_key("$schema", "JSON Schema for editors (jobs/schema.json); ignored by rodsweep").defaults_to("").setting(),
  };
}

std::vector<Key> keys_of_simulations() {
  std::vector<Key> keys{
      integer_key("samples", "draws of the random values at every grid point")
          .from(1, 1000000)
          .defaults_to(1)
          .setting(),
      choice_key("sampling",
                 "random values: independent, or from the Sobol sequence, which covers ranges more evenly (best with a "
                 "power of two samples)",
                 {"random", "sobol"})
          .defaults_to("random")
          .setting(),
      choice_key("evaluation", "all guesses on the systems of one trajectory, or each guess on its own trajectory",
                 {"paired", "closed_loop"})
          .defaults_to("paired")
          .only({"sweep"}, no_guesses),
      scene_key(),
      start_key().only({"sweep"}, "a data set starts as its scene does"),
      time_key(),
      solve_key().only({"sweep"}, no_guesses),
      guesses_key("guesses", "initial guesses of cg")
          .defaults_to(Json::array())
          .only({"sweep"}, no_guesses)
          .unswept("all tasks share one list of guesses; list every guess, or sweep one guess of the list"),
      record(),
      number_key("task_time_limit_s", "a task that takes longer is recorded as timed out; 0: no limit")
          .in("s")
          .from(0, 1e9)
          .defaults_to(0)
          .setting(),
  };
  for (Key& key : keys)
    if (key.only_for.empty())
      key.only({"sweep", "dataset"}, "a training uses the simulations in \"data\": remove this key");
  return keys;
}

Key job() {
  std::vector<Key> keys = keys_of_all();
  for (std::vector<Key> more : {keys_of_simulations(), training_keys()})
    keys.insert(keys.end(), more.begin(), more.end());
  return object_key("job", "a job", keys, "kind").unswept("sweep a value instead");
}

}  // namespace

const Key& job_key() {
  static const Key key = job();
  return key;
}

}  // namespace rodsweep
