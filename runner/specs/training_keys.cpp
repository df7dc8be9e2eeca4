#include "runner/specs/training_job.hpp"

namespace rodsweep {
namespace {

using Json = nlohmann::ordered_json;

/// Applies to the key and all its members.
Key never_swept(Key key) {
  key.setting().no_sweep_advice = "a job trains one model; write one job per model";
  for (Key& child : key.keys) child = never_swept(child);
  return key;
}

Key training() {
  return object_key(
             "training", "how the network is trained",
             {
                 choice_key("loss",
                            "mse: mean squared error of the outputs; energy: energy norm of the error of the guess; "
                            "in_the_loop: the same after a few steps of CG",
                            {"mse", "energy", "in_the_loop"})
                     .defaults_to("energy"),
                 integer_key("cg_steps",
                             "CG steps before the error is measured; for factors of all couplings, corrections")
                     .from(1, 100)
                     .defaults_to(4)
                     .only({"in_the_loop"}),
                 integer_key("epochs", "passes over the training examples").from(1, 1000000).defaults_to(120),
                 integer_key("batch", "examples in a step of the optimiser")
                     .from(1, 100000)
                     .defaults_to(16)
                     .also_called({"batch_size"}),
                 integer_key("shards",
                             "equal parts of a batch (a divisor of it), and maximum number of ranks that share the "
                             "work; results depend on it, but not on the number of ranks")
                     .from(1, 100000)
                     .defaults_to(4),
                 number_key("rate", "largest step size of Adam: it rises linearly, then falls along a cosine")
                     .above(0)
                     .at_most(1)
                     .defaults_to(2e-3)
                     .also_called({"learning_rate", "lr"}),
                 number_key("warm_up", "fraction of all steps in which the rate rises").from(0, 0.5).defaults_to(0.02),
                 number_key("weight_decay", "decoupled decay of the weights").from(0, 1).defaults_to(0),
                 number_key("clip",
                            "maximum norm of a gradient; larger ones, and those over three times the usual norm, are "
                            "scaled down")
                     .above(0)
                     .at_most(1e9)
                     .defaults_to(1),
                 choice_key("systems", "systems of the data sets to train on: all, or those of first Newton iterations",
                            {"first", "all"})
                     .defaults_to("all"),
                 integer_key("turned_copies",
                             "copies per example, randomly turned about gravity and shifted; for the encodings paper "
                             "and paper_residual")
                     .from(0, 100)
                     .defaults_to(0),
                 integer_key(
                     "noisy_copies",
                     "copies per example, with noise in their histories and randomly rolled; for the encoding state")
                     .from(0, 100)
                     .defaults_to(0),
                 number_key("noise",
                            "noisy copies: standard deviation of the noise in a history's last velocities, relative to "
                            "the velocity change of a step")
                     .from(0, 10)
                     .defaults_to(0.1),
                 integer_key("patience_epochs",
                             "epochs without a better validation loss after which the training ends; 0: never")
                     .from(0, 1000000)
                     .defaults_to(0)
                     .also_called({"early_stopping"}),
                 integer_key(
                     "ratio_every_epochs",
                     "epochs between measurements of the CG ratio on validation simulations; 0: only at the end")
                     .from(0, 1000000)
                     .defaults_to(10),
                 integer_key("ratio_simulations", "maximum number of simulations for the CG ratio")
                     .from(1, 1000000)
                     .defaults_to(50),
             },
             "loss")
      .defaults_to(Json::object());
}

}  // namespace

Key network_key() {
  return object_key(
             "network", "the network that is trained",
             {
                 choice_key("encoding",
                            "inputs of the network. paper: the features of Shao et al., 14 per segment and 5 per "
                            "joint; paper_residual: the same, and the constraint residual from the second Newton "
                            "iteration on; linear_system: the scaled linear system, invariant to turning, rolling and "
                            "mirroring; state: the last five velocities, for solve.method state_network",
                            {"paper", "paper_residual", "linear_system", "state"})
                     .defaults_to("linear_system"),
                 choice_key("processor",
                            "factors: predicts factors of the matrix, block by block, and solves with them; "
                            "message_passing: over the graph",
                            {"factors", "message_passing"})
                     .defaults_to("factors"),
                 choice_key("base", "the guess that the network corrects",
                            {"none", "extrapolation", "regression", "subspace"})
                     .defaults_to("regression"),
                 integer_key("base_size", "regression, subspace: maximum number of solutions")
                     .from(1, 200)
                     .defaults_to(6),
                 integer_key("latent", "width of hidden layers and states").from(1, 1024).defaults_to(16),
                 choice_key(
                     "couplings",
                     "factors: couplings of joints in the factors: along the tree, or all (for nets and lattices)",
                     {"tree", "all"})
                     .defaults_to("tree")
                     .only({"factors"}),
                 integer_key("steps", "message_passing: hops over the graph")
                     .from(1, 100)
                     .defaults_to(6)
                     .only({"message_passing"}),
                 integer_key("hidden_layers", "message_passing: hidden layers of every multilayer perceptron")
                     .from(1, 10)
                     .defaults_to(1)
                     .only({"message_passing"}),
                 boolean_key("globals", "message_passing: with a global state of the graph")
                     .defaults_to(false)
                     .only({"message_passing"}),
                 boolean_key("best_length", "scale the correction to minimise the energy of the error")
                     .defaults_to(true),
                 boolean_key("moves", "message_passing: also predict the moves of segments")
                     .defaults_to(false)
                     .only({"message_passing"}, "factors work only on joints"),
             },
             "processor")
      .defaults_to(Json::object());
}

std::vector<Key> training_keys() {
  std::vector<Key> keys{
      text_key("data", "training data: the file of a job of kind \"dataset\"")
          .at_most(4000)
          .of_form(Key::Text::line)
          .or_list_of_such(),
      integer_key("training_simulations",
                  "number of training simulations per data set, from the first; 0: all except those for validation")
          .from(0, 1000000)
          .defaults_to(0),
      integer_key("validation_simulations", "number of validation simulations per data set, from its last samples")
          .from(1, 1000000)
          .defaults_to(100),
      network_key(), training()};
  for (Key& key : keys) key = never_swept(key).only({"train"});
  return keys;
}

}  // namespace rodsweep
