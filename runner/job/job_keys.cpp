#include "runner/job/job_keys.hpp"

#include "runner/job/scene_keys.hpp"
#include "runner/job/training_keys.hpp"

namespace rodsweep {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* no_guesses = "only a sweep tries guesses: remove this key";

Key time() {
  return object_key(
      "time", "time stepping",
      {
          number_key("step_s", "time step").in("s").above(0).at_most(1000).also_called({"dt", "dt_s", "time_step_s"}),
          integer_key("steps", "number of time steps").at_least(1).at_most(10000000).one_of_group("length of the run"),
          number_key("duration_s", "simulated time, a whole number of steps")
              .in("s")
              .above(0)
              .at_most(1e9)
              .one_of_group("length of the run"),
          integer_key("newton_iterations",
                      "most Newton iterations in a step; not of xpbd and pbd, which have their own")
              .at_least(1)
              .at_most(1000)
              .defaults_to(6),
          number_key("newton_tolerance", "a step's iterations end when max |C + alpha~ lambda| is below it")
              .at_least(0)
              .at_most(1)
              .defaults_to(1e-9),
      });
}

Key solve() {
  return object_key("solve", "what moves the rods towards their constraints: mostly linear solves",
                    {
                        choice_key("method",
                                   "conjugate gradients with counted iterations, the direct solve alone, or in a "
                                   "closed loop what does without linear systems: a network's answers, or Gauss-Seidel "
                                   "over the joints, with compliances (xpbd) or without (pbd)",
                                   {"cg", "direct", "end_to_end", "xpbd", "pbd"})
                            .defaults_to("cg"),
                        file_key("model", "model file of a train job")
                            .only({"end_to_end"}, "a model that starts cg is a guess, \"copingnet\""),
                        integer_key("iterations", "most Gauss-Seidel iterations in a step")
                            .at_least(1)
                            .at_most(10000)
                            .defaults_to(20)
                            .only({"xpbd", "pbd"}, "cg has max_iterations, Newton time.newton_iterations"),
                        number_key("stretch_stiffness", "share of a stretch or shear that one correction takes away")
                            .at_least(0)
                            .at_most(1)
                            .defaults_to(1)
                            .only({"pbd"}, "moduli and stretch_compliance_per_j of the scene say how stiff a rod is"),
                        number_key("bending_stiffness", "share of a bend or twist that one correction takes away")
                            .at_least(0)
                            .at_most(1)
                            .defaults_to(1)
                            .only({"pbd"}, "moduli of the scene say how stiff a rod is"),
                        choice_key("preconditioner", "preconditioner of cg",
                                   {"none", "jacobi", "point_block_jacobi", "icc", "cholesky", "lagged_cholesky"})
                            .defaults_to("jacobi"),
                        integer_key("lag_steps",
                                    "lagged_cholesky: time steps from one factorisation, of the first Newton "
                                    "iteration's matrix, to the next")
                            .at_least(1)
                            .at_most(1000000)
                            .defaults_to(10),
                        choice_key("norm", "residual norm of the stopping test of cg", {"true_residual", "natural"})
                            .defaults_to("true_residual"),
                        number_key("tolerance",
                                   "tolerance of the timed solves, relative to ||b||; in a closed loop also of "
                                   "those that advance the rod")
                            .above(0)
                            .at_most(1)
                            .defaults_to(1e-2),
                        integer_key("max_iterations", "limit on cg iterations; 0: ten times the number of unknowns")
                            .at_least(0)
                            .at_most(32767)
                            .defaults_to(0),
                        integer_key("timing_repeats", "times are medians over so many repeats of guess and solve")
                            .at_least(1)
                            .at_most(1000)
                            .defaults_to(1),
                    },
                    "method")
      .defaults_to(Json::object());
}

Key record() {
  return object_key(
             "record", "what is written",
             {
                 choice_key("solves", "a row for every solve, or only sums for every task", {"all", "summary"})
                     .defaults_to("all")
                     .setting(),
                 choice_key("norms", "count iterations in both norms, or only in the one that the job tests (faster)",
                            {"both", "one"})
                     .defaults_to("both")
                     .only({"sweep"}, no_guesses)
                     .setting(),
                 choice_key("systems",
                            "of which linear systems the rods, the multipliers and the solution are stored: those of "
                            "the first Newton iteration of every step, or all",
                            {"first", "all"})
                     .defaults_to("first")
                     .only({"dataset"}, "make the simulations a job of that kind")
                     .setting(),
                 integer_key("trajectory_every", "a frame of all segments every so many steps; 0: none")
                     .at_least(0)
                     .at_most(10000000)
                     .defaults_to(0)
                     .setting(),
             })
      .defaults_to(Json::object())
      .setting();
}

Key subspace_size() {
  return integer_key("size", "most solutions that span the subspace; each costs a product with A")
      .at_least(1)
      .at_most(200)
      .defaults_to(10);
}

std::vector<Key> keys_of_all() {
  return {
      text_key("name", "name of the job and of its results file").at_most(100).of_form(Key::Text::file_name).setting(),
      text_key("description", "a remark for the reader")
          .defaults_to("")
          .also_called({"comment", "//", "_comment", "note", "#"})
          .setting(),
      choice_key("kind", "kind of job", {"sweep", "dataset", "train"}).setting(),
      integer_key("seed", "seed of all random values").at_least(0).at_most(9007199254740991).defaults_to(0).setting(),
      text_key("$schema", "the JSON Schema by which an editor helps (jobs/schema.json); not read here")
          .defaults_to("")
          .setting(),
  };
}

std::vector<Key> keys_of_simulations() {
  std::vector<Key> keys{
      integer_key("samples", "draws of the random values at every grid point")
          .at_least(1)
          .at_most(1000000)
          .defaults_to(1)
          .setting(),
      choice_key("sampling",
                 "how random values are drawn: independently, or by Sobol's sequence, which covers their "
                 "ranges more evenly (best for a power of two of samples)",
                 {"random", "sobol"})
          .defaults_to("random")
          .setting(),
      choice_key("evaluation", "all guesses on the systems of one trajectory, or each on a trajectory of its own",
                 {"paired", "closed_loop"})
          .defaults_to("paired")
          .only({"sweep"}, no_guesses),
      scene_key(),
      time(),
      solve().only({"sweep"}, no_guesses),
      guesses_key("guesses", "initial guesses of cg")
          .defaults_to(Json::array())
          .only({"sweep"}, no_guesses)
          .unswept("all tasks share one list of guesses; put every guess in it, or a sweep in place of a guess"),
      record(),
      number_key("task_time_limit_s", "a task that takes longer is recorded as timed out; 0: no limit")
          .in("s")
          .at_least(0)
          .at_most(1e9)
          .defaults_to(0)
          .setting(),
  };
  for (Key& key : keys)
    if (key.only_for.empty())
      key.only({"sweep", "dataset"}, "a training learns from the simulations in \"data\": remove this key");
  return keys;
}

Key job() {
  std::vector<Key> keys = keys_of_all();
  for (std::vector<Key> more : {keys_of_simulations(), training_keys()})
    keys.insert(keys.end(), more.begin(), more.end());
  return object_key("job", "a job", keys, "kind").unswept("put the sweep in place of a value");
}

}  // namespace

const Key& job_key() {
  static const Key key = job();
  return key;
}

const std::vector<Key>& guess_keys() {
  static const std::vector<Key> keys{
      object_key("zero", "no guess: the denominator of every ratio", {}),
      object_key("previous", "the solution of the same Newton iteration of the last step", {}),
      object_key("linear", "linear extrapolation in time", {}),
      object_key("quadratic", "quadratic extrapolation in time", {}),
      object_key("fischer",
                 "best approximation within the last solutions, collected until there are `size`, then from one again",
                 {subspace_size()}),
      object_key("pod", "best approximation within the last `size` solutions", {subspace_size()}),
      object_key("copingnet", "a learned guess: a network's correction of the guess that it was trained with",
                 {file_key("model", "model file of a train job")}),
      object_key("knn", "the solutions of the most similar systems of a data set, resampled by arc length and averaged",
                 {integer_key("k", "how many").at_least(1).at_most(1000).defaults_to(3).also_called({"neighbours"}),
                  file_key("data", "data set: the file of a job of kind \"dataset\"").unlabelled(),
                  integer_key("simulations", "the first so many simulations of the data set, or fewer; 0: all")
                      .at_least(0)
                      .at_most(1000000)
                      .defaults_to(0)
                      .unlabelled()}),
      object_key("oracle", "the exact solution plus a random error",
                 {number_key("error", "A-norm of the error relative to the solution's")
                      .at_least(0)
                      .at_most(1e6)
                      .defaults_to(0.1),
                  choice_key("errors", "white: independent in every entry; smooth: of the modes that CG finds last",
                             {"white", "smooth"})
                      .defaults_to("white")}),
      object_key(
          "guarded", "another guess, used only where its residual is small",
          {guess_key("guess", "the guess that is guarded"),
           number_key("threshold", "the guess is used where the natural norm of b - A x0 is below this times b's")
               .above(0)
               .at_most(1e6)}),
  };
  return keys;
}

const Key& guess_label_key() {
  static const Key key = text_key("label", "name of the guess in files and figures")
                             .at_most(60)
                             .of_form(Key::Text::line)
                             .unswept("a label names the same guess in all tasks");
  return key;
}

}  // namespace rodsweep
