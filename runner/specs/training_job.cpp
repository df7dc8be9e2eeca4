#include "runner/specs/training_job.hpp"

#include "network/processor/factor_inference.hpp"
#include "runner/text/job_error.hpp"
#include "runner/text/words.hpp"

namespace rodsweep {
namespace {

using Json = nlohmann::ordered_json;

const Words<Encoding> encodings{{"paper", Encoding::paper},
                                {"paper_residual", Encoding::paper_residual},
                                {"linear_system", Encoding::linear_system},
                                {"state", Encoding::state}};
const Words<Processor> processors{{"factors", Processor::factors}, {"message_passing", Processor::message_passing}};
const Words<Couplings> all_couplings{{"tree", Couplings::tree}, {"all", Couplings::all}};
const Words<BaseGuess> bases{{"none", BaseGuess::none},
                             {"extrapolation", BaseGuess::extrapolation},
                             {"regression", BaseGuess::regression},
                             {"subspace", BaseGuess::subspace}};
const Words<LossKind> losses{
    {"mse", LossKind::mse}, {"energy", LossKind::energy}, {"in_the_loop", LossKind::in_the_loop}};

TrainingSettings training_settings(const Json& values, std::uint64_t seed) {
  TrainingSettings settings;
  settings.loss = value_of(losses, values["loss"]);
  settings.cg_steps = values.value("cg_steps", settings.cg_steps);
  settings.epochs = values["epochs"];
  settings.batch = values["batch"];
  settings.shards = values["shards"];
  settings.rate = values["rate"];
  settings.warm_up = values["warm_up"];
  settings.weight_decay = values["weight_decay"];
  settings.clip = values["clip"];
  settings.seed = seed;
  return settings;
}

/// Throws JobError unless a "state" network uses message passing and learns accelerations from a mean squared error.
void check_state(const TrainingJob& training, const std::filesystem::path& file) {
  const auto want = [&](bool holds, const char* key, const std::string& value, const char* must) {
    if (!holds)
      throw job_error(file, key, "{} is not allowed with network.encoding \"state\"; must be {}", value, must);
  };
  const auto quoted = [](const std::string& word) { return '"' + word + '"'; };
  const CopingNetSettings& network = training.network;
  want(network.processor == Processor::message_passing, "network.processor",
       quoted(word_of(processors, network.processor)), "\"message_passing\"");
  want(network.base == BaseGuess::none, "network.base", quoted(word_of(bases, network.base)), "\"none\"");
  want(network.moves, "network.moves", "false", "true");
  want(training.training.loss == LossKind::mse, "training.loss", quoted(word_of(losses, training.training.loss)),
       "\"mse\"");
  want(training.turned_copies == 0, "training.turned_copies", std::to_string(training.turned_copies),
       "0: it does not depend on turning");
}

void check(const TrainingJob& training, const std::filesystem::path& file) {
  const TrainingSettings& settings = training.training;
  if (settings.batch % settings.shards != 0) {
    throw job_error(file, "training.shards", "{} is not allowed; must be a divisor of training.batch, {}",
                    settings.shards, settings.batch);
  }
  if (!is_guess(training.network)) return check_state(training, file);
  if (training.network.processor == Processor::factors && training.network.encoding != Encoding::linear_system) {
    throw job_error(file, "network.encoding",
                    "\"{}\" is not allowed with network.processor \"factors\"; must be \"linear_system\", or use "
                    "network.processor \"message_passing\"",
                    word_of(encodings, training.network.encoding));
  }
  if (training.network.processor == Processor::factors && !FactorInference::supports(training.network.latent)) {
    throw job_error(file, "network.latent",
                    "{} is not allowed with network.processor \"factors\"; must be a multiple of 16",
                    training.network.latent);
  }
  if (training.noisy_copies > 0) {
    throw job_error(file, "training.noisy_copies",
                    "{} is not allowed with network.encoding \"{}\"; must be used with \"state\"",
                    training.noisy_copies, word_of(encodings, training.network.encoding));
  }
  if (training.turned_copies > 0 && !is_of_graphs(training.network.encoding)) {
    throw job_error(file, "training.turned_copies",
                    "{} is not allowed with network.encoding \"{}\", which does not depend on turning; remove this key",
                    training.turned_copies, word_of(encodings, training.network.encoding));
  }
  if (training.network.moves && settings.loss != LossKind::mse) {
    throw job_error(
        file, "network.moves",
        "true is not allowed with training.loss \"{}\", which does not train moves; use \"mse\" or remove this key",
        word_of(losses, settings.loss));
  }
}

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
                     .positive(1)
                     .defaults_to(2e-3)
                     .also_called({"learning_rate", "lr"}),
                 number_key("warm_up", "fraction of all steps in which the rate rises").from(0, 0.5).defaults_to(0.02),
                 number_key("weight_decay", "decoupled decay of the weights").from(0, 1).defaults_to(0),
                 number_key("clip",
                            "maximum norm of a gradient; larger ones, and those over three times the usual norm, are "
                            "scaled down")
                     .positive(1e9)
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

CopingNetSettings network_settings(const Json& values) {
  CopingNetSettings settings;
  settings.encoding = value_of(encodings, values["encoding"]);
  settings.processor = value_of(processors, values["processor"]);
  settings.base = value_of(bases, values["base"]);
  settings.base_size = values["base_size"];
  settings.latent = values["latent"];
  settings.couplings = value_of(all_couplings, values.value("couplings", "tree"));
  settings.steps = values.value("steps", settings.steps);
  settings.hidden_layers = values.value("hidden_layers", settings.hidden_layers);
  settings.globals = values.value("globals", settings.globals);
  settings.best_length = values["best_length"];
  settings.moves = values.value("moves", settings.moves);
  return settings;
}

Json network_json(const CopingNetSettings& settings) {
  Json values{{"encoding", word_of(encodings, settings.encoding)},
              {"processor", word_of(processors, settings.processor)},
              {"base", word_of(bases, settings.base)},
              {"base_size", settings.base_size},
              {"latent", settings.latent},
              {"best_length", settings.best_length}};
  if (has_all_couplings(settings)) values["couplings"] = word_of(all_couplings, settings.couplings);
  if (settings.processor == Processor::message_passing)
    values.update({{"steps", settings.steps}, {"globals", settings.globals}, {"moves", settings.moves}});
  if (settings.processor == Processor::message_passing && settings.hidden_layers > 1)
    values["hidden_layers"] = settings.hidden_layers;
  return values;
}

TrainingJob training_job(const Json& values, const std::filesystem::path& file) {
  const Json& training = values["training"];
  TrainingJob out;
  const Json& data = values["data"];
  for (const Json& set : data.is_array() ? data : Json::array({data}))
    out.data.push_back((file.parent_path() / set.get<std::string>()).lexically_normal());
  out.validation_simulations = values["validation_simulations"];
  out.training_simulations = values["training_simulations"];
  out.network = network_settings(values["network"]);
  out.training = training_settings(training, values["seed"]);
  out.first_iterations_only = training["systems"] == "first";
  out.turned_copies = training["turned_copies"];
  out.noisy_copies = training["noisy_copies"];
  out.noise = training["noise"];
  out.patience_epochs = training["patience_epochs"];
  out.ratio_every_epochs = training["ratio_every_epochs"];
  out.ratio_simulations = training["ratio_simulations"];
  check(out, file);
  return out;
}

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
