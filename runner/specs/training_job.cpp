#include "runner/specs/training_job.hpp"

#include "network/processor/factor_inference.hpp"
#include "runner/keys/key_table.hpp"
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

const KeyTable<CopingNetSettings>& network_table() {
  static const auto table =
      KeyTable<CopingNetSettings>()
          .optional(
              choice_key("encoding",
                         "inputs of the network. paper: the features of Shao et al., 14 per segment and 5 per "
                         "joint; paper_residual: the same, and the constraint residual from the second Newton "
                         "iteration on; linear_system: the scaled linear system, invariant to turning, rolling and "
                         "mirroring; state: the last five velocities, for solve.method state_network"),
              encodings, &CopingNetSettings::encoding)
          .optional(choice_key("processor",
                               "factors: predicts factors of the matrix, block by block, and solves with them; "
                               "message_passing: over the graph"),
                    processors, &CopingNetSettings::processor)
          .optional(choice_key("base", "the guess that the network corrects"), bases, &CopingNetSettings::base)
          .optional(integer_key("base_size", "regression, subspace: maximum number of solutions").from(1, 200),
                    &CopingNetSettings::base_size)
          .optional(integer_key("latent", "width of hidden layers and states").from(1, 1024),
                    &CopingNetSettings::latent)
          .optional(
              choice_key("couplings",
                         "factors: couplings of joints in the factors: along the tree, or all (for nets and lattices)")
                  .only({"factors"}),
              all_couplings, &CopingNetSettings::couplings)
          .optional(integer_key("steps", "message_passing: hops over the graph").from(1, 100).only({"message_passing"}),
                    &CopingNetSettings::steps)
          .optional(integer_key("hidden_layers", "message_passing: hidden layers of every multilayer perceptron")
                        .from(1, 10)
                        .only({"message_passing"}),
                    &CopingNetSettings::hidden_layers)
          .optional(
              boolean_key("globals", "message_passing: with a global state of the graph").only({"message_passing"}),
              &CopingNetSettings::globals)
          .optional(boolean_key("best_length", "scale the correction to minimise the energy of the error"),
                    &CopingNetSettings::best_length)
          .optional(boolean_key("moves", "message_passing: also predict the moves of segments")
                        .only({"message_passing"}, "factors work only on joints"),
                    &CopingNetSettings::moves);
  return table;
}

const KeyTable<TrainingJob>& training_table() {
  const auto of = [](auto TrainingSettings::*member) {
    return [member](TrainingJob & job) -> auto& { return job.training.*member; };
  };
  static const auto table =
      KeyTable<TrainingJob>()
          .optional(choice_key("loss",
                               "mse: mean squared error of the outputs; energy: energy norm of the error of the guess; "
                               "in_the_loop: the same after a few steps of CG"),
                    losses, of(&TrainingSettings::loss))
          .optional(integer_key("cg_steps",
                                "CG steps before the error is measured; for factors of all couplings, corrections")
                        .from(1, 100)
                        .only({"in_the_loop"}),
                    of(&TrainingSettings::cg_steps))
          .optional(integer_key("epochs", "passes over the training examples").from(1, 1000000).defaults_to(120),
                    of(&TrainingSettings::epochs))
          .optional(integer_key("batch", "examples in a step of the optimiser")
                        .from(1, 100000)
                        .defaults_to(16)
                        .also_called({"batch_size"}),
                    of(&TrainingSettings::batch))
          .optional(integer_key("shards",
                                "equal parts of a batch (a divisor of it), and maximum number of ranks that share the "
                                "work; results depend on it, but not on the number of ranks")
                        .from(1, 100000),
                    of(&TrainingSettings::shards))
          .optional(number_key("rate", "largest step size of Adam: it rises linearly, then falls along a cosine")
                        .positive(1)
                        .also_called({"learning_rate", "lr"}),
                    of(&TrainingSettings::rate))
          .optional(number_key("warm_up", "fraction of all steps in which the rate rises").from(0, 0.5),
                    of(&TrainingSettings::warm_up))
          .optional(number_key("weight_decay", "decoupled decay of the weights").from(0, 1),
                    of(&TrainingSettings::weight_decay))
          .optional(
              number_key("clip",
                         "maximum norm of a gradient; larger ones, and those over three times the usual norm, are "
                         "scaled down")
                  .positive(1e9),
              of(&TrainingSettings::clip))
          .optional(
              choice_key("systems", "systems of the data sets to train on: all, or those of first Newton iterations"),
              Words<bool>{{"first", true}, {"all", false}}, &TrainingJob::first_iterations_only)
          .optional(
              integer_key("turned_copies",
                          "copies per example, randomly turned about gravity and shifted; for the encodings paper "
                          "and paper_residual")
                  .from(0, 100),
              &TrainingJob::turned_copies)
          .optional(integer_key(
                        "noisy_copies",
                        "copies per example, with noise in their histories and randomly rolled; for the encoding state")
                        .from(0, 100),
                    &TrainingJob::noisy_copies)
          .optional(
              number_key("noise",
                         "noisy copies: standard deviation of the noise in a history's last velocities, relative to "
                         "the velocity change of a step")
                  .from(0, 10),
              &TrainingJob::noise)
          .optional(integer_key("patience_epochs",
                                "epochs without a better validation loss after which the training ends; 0: never")
                        .from(0, 1000000)
                        .also_called({"early_stopping"}),
                    &TrainingJob::patience_epochs)
          .optional(
              integer_key("ratio_every_epochs",
                          "epochs between measurements of the CG ratio on validation simulations; 0: only at the end")
                  .from(0, 1000000),
              &TrainingJob::ratio_every_epochs)
          .optional(integer_key("ratio_simulations", "maximum number of simulations for the CG ratio").from(1, 1000000),
                    &TrainingJob::ratio_simulations);
  return table;
}

/// The keys beside `network` and `training`.
const KeyTable<TrainingJob>& data_table() {
  static const auto table =
      KeyTable<TrainingJob>()
          .unbound(text_key("data", "training data: the file of a job of kind \"dataset\"")
                       .at_most(4000)
                       .of_form(Key::Text::line)
                       .or_list_of_such())
          .optional(
              integer_key(
                  "training_simulations",
                  "number of training simulations per data set, from the first; 0: all except those for validation")
                  .from(0, 1000000),
              &TrainingJob::training_simulations)
          .optional(integer_key("validation_simulations",
                                "number of validation simulations per data set, from its last samples")
                        .from(1, 1000000),
                    &TrainingJob::validation_simulations);
  return table;
}

}  // namespace

CopingNetSettings network_settings(const Json& values) {
  CopingNetSettings settings;
  network_table().fill(settings, {ObjectPoint(values), {}, ""});
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
  TrainingJob out;
  const Json& data = values["data"];
  for (const Json& set : data.is_array() ? data : Json::array({data}))
    out.data.push_back((file.parent_path() / set.get<std::string>()).lexically_normal());
  const ObjectPoint point(values);
  const JobFiles job{file, {}};
  data_table().fill(out, {point, job, ""});
  network_table().fill(out.network, {point, job, "network"});
  training_table().fill(out, {point, job, "training"});
  out.training.seed = values["seed"];
  check(out, file);
  return out;
}

Key network_key() {
  return object_key("network", "the network that is trained", network_table().keys(), "processor")
      .defaults_to(Json::object());
}

std::vector<Key> training_keys() {
  std::vector<Key> keys = data_table().keys();
  keys.push_back(network_key());
  keys.push_back(object_key("training", "how the network is trained", training_table().keys(), "loss")
                     .defaults_to(Json::object()));
  for (Key& key : keys) key = never_swept(key).only({"train"});
  return keys;
}

}  // namespace rodsweep
