#include "runner/job/training_job.hpp"

namespace rodsweep {
namespace {

using Json = nlohmann::ordered_json;

/// Applies to the key and all its members.
Key never_swept(Key key) {
  key.setting().no_sweep_advice = "a job trains one model; write another job for another";
  for (Key& child : key.keys) child = never_swept(child);
  return key;
}

Key training() {
  return object_key(
             "training", "how the network is trained",
             {
                 choice_key("loss",
                            "what is made small: the mean squared error of the outputs, the energy norm of the error "
                            "that the guess leaves, or what is left of it after a few steps of CG",
                            {"mse", "energy", "in_the_loop"})
                     .defaults_to("energy"),
                 integer_key("cg_steps",
                             "steps of CG before the error is measured; of factors of all couplings, corrections")
                     .from(1, 100)
                     .defaults_to(4)
                     .only({"in_the_loop"}),
                 integer_key("epochs", "passes over the training examples").from(1, 1000000).defaults_to(120),
                 integer_key("batch", "examples in a step of the optimiser")
                     .from(1, 100000)
                     .defaults_to(16)
                     .also_called({"batch_size"}),
                 integer_key("shards",
                             "equal parts of a batch, a divisor of it: as many ranks at most share the work; results "
                             "depend on it, but not on the number of ranks")
                     .from(1, 100000)
                     .defaults_to(4),
                 number_key("rate", "largest step size of Adam, which rises linearly and falls along a cosine")
                     .above(0)
                     .at_most(1)
                     .defaults_to(2e-3)
                     .also_called({"learning_rate", "lr"}),
                 number_key("warm_up", "part of all steps in which the rate rises").from(0, 0.5).defaults_to(0.02),
                 number_key("weight_decay", "decoupled decay of the weights").from(0, 1).defaults_to(0),
                 number_key("clip", "largest norm of a gradient, above which it is scaled down")
                     .above(0)
                     .at_most(1e9)
                     .defaults_to(1),
                 choice_key("systems",
                            "learned from, of those that the data sets hold: all, or those of first Newton iterations",
                            {"first", "all"})
                     .defaults_to("all"),
                 integer_key("turned_copies",
                             "of every example, turned about gravity at random and shifted; for encodings that depend "
                             "on where a rod is: paper and paper_residual")
                     .from(0, 100)
                     .defaults_to(0),
                 integer_key("noisy_copies",
                             "of every example, with noise in their histories and rolled at random; for the encoding "
                             "state")
                     .from(0, 100)
                     .defaults_to(0),
                 number_key("noise",
                            "of noisy copies: standard deviation of a history's last velocities, relative to what a "
                            "step adds to velocities")
                     .from(0, 10)
                     .defaults_to(0.1),
                 integer_key("patience_epochs", "ends after so many epochs without a better validation loss; 0: never")
                     .from(0, 1000000)
                     .defaults_to(0)
                     .also_called({"early_stopping"}),
                 integer_key("ratio_every_epochs",
                             "the CG ratio on validation simulations is measured every so many epochs, and at the "
                             "end; 0: at the end only")
                     .from(0, 1000000)
                     .defaults_to(10),
                 integer_key("ratio_simulations", "on how many, at most").from(1, 1000000).defaults_to(50),
             },
             "loss")
      .defaults_to(Json::object());
}

}  // namespace

Key network_key() {
  return object_key(
             "network", "the network that is trained",
             {
                 choice_key(
                     "encoding",
                     "the network's inputs. paper: the features of Shao et al., 14 of a segment and 5 of a joint; "
                     "paper_residual: the same, and the constraint residual from the second Newton iteration on; "
                     "linear_system: the scaled linear system in frames that turning, rolling and mirroring do not "
                     "change; state: the last five velocities, for solve.method state_network",
                     {"paper", "paper_residual", "linear_system", "state"})
                     .defaults_to("linear_system"),
                 choice_key(
                     "processor",
                     "factors: of the matrix, block by block, and a solve with them; message_passing: over the graph",
                     {"factors", "message_passing"})
                     .defaults_to("factors"),
                 choice_key("base", "the guess that it corrects", {"none", "extrapolation", "regression", "subspace"})
                     .defaults_to("regression"),
                 integer_key("base_size", "regression, subspace: most solutions that span the subspace")
                     .from(1, 200)
                     .defaults_to(6),
                 integer_key("latent", "width of hidden layers and states").from(1, 1024).defaults_to(16),
                 choice_key(
                     "couplings",
                     "factors: the couplings of joints that they contain, those along the tree, or all, for nets "
                     "and lattices",
                     {"tree", "all"})
                     .defaults_to("tree")
                     .only({"factors"}),
                 integer_key("steps", "message_passing: hops over the graph")
                     .from(1, 100)
                     .defaults_to(6)
                     .only({"message_passing"}),
                 integer_key("hidden_layers", "message_passing: of every multilayer perceptron")
                     .from(1, 10)
                     .defaults_to(1)
                     .only({"message_passing"}),
                 boolean_key("globals", "message_passing: with a state of the whole graph")
                     .defaults_to(false)
                     .only({"message_passing"}),
                 boolean_key("best_length", "the correction is scaled to what lowers the error's energy most")
                     .defaults_to(true),
                 boolean_key("moves", "message_passing: also predict the moves of segments")
                     .defaults_to(false)
                     .only({"message_passing"}, "factors work on joints alone"),
             },
             "processor")
      .defaults_to(Json::object());
}

std::vector<Key> training_keys() {
  std::vector<Key> keys{
      text_key("data", "data set to learn from: the file of a job of kind \"dataset\"")
          .at_most(4000)
          .of_form(Key::Text::line)
          .or_list_of_such(),
      integer_key("training_simulations",
                  "learned from: the first so many simulations of every data set; 0: all that are not for validation")
          .from(0, 1000000)
          .defaults_to(0),
      integer_key("validation_simulations",
                  "the last so many simulations of every data set, of its last samples, are not learned from")
          .from(1, 1000000)
          .defaults_to(100),
      network_key(), training()};
  for (Key& key : keys) key = never_swept(key).only({"train"});
  return keys;
}

}  // namespace rodsweep
