#include "runner/specs/training_job.hpp"

#include <fmt/format.h>

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
      throw job_error(file, key,
                      fmt::format("{} is not allowed with network.encoding \"state\"; must be {}", value, must));
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
    throw job_error(
        file, "training.shards",
        fmt::format("{} is not allowed; must be a divisor of training.batch, {}", settings.shards, settings.batch));
  }
  if (!is_guess(training.network)) return check_state(training, file);
  if (training.network.processor == Processor::factors && training.network.encoding != Encoding::linear_system) {
    throw job_error(file, "network.encoding",
                    fmt::format("\"{}\" is not allowed with network.processor \"factors\"; must be \"linear_system\", "
                                "or use network.processor \"message_passing\"",
                                word_of(encodings, training.network.encoding)));
  }
  if (training.network.processor == Processor::factors && !FactorInference::supports(training.network.latent)) {
    throw job_error(file, "network.latent",
                    fmt::format("{} is not allowed with network.processor \"factors\"; must be a multiple of 16",
                                training.network.latent));
  }
  if (training.noisy_copies > 0) {
    throw job_error(file, "training.noisy_copies",
                    fmt::format("{} is not allowed with network.encoding \"{}\"; must be used with \"state\"",
                                training.noisy_copies, word_of(encodings, training.network.encoding)));
  }
  if (training.turned_copies > 0 && !is_of_graphs(training.network.encoding)) {
    throw job_error(
        file, "training.turned_copies",
        fmt::format("{} is not allowed with network.encoding \"{}\", which does not depend on turning; remove this key",
                    training.turned_copies, word_of(encodings, training.network.encoding)));
  }
  if (training.network.moves && settings.loss != LossKind::mse) {
    throw job_error(file, "network.moves",
                    fmt::format("true is not allowed with training.loss \"{}\", which does not train "
                                "moves; use \"mse\" or remove this key",
                                word_of(losses, settings.loss)));
  }
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

}  // namespace rodsweep
