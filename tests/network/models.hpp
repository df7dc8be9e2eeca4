// Networks with random weights for tests. Outputs have the right shapes but no meaning.
#pragma once

#include <memory>

#include "network/processor/model.hpp"

namespace rodsweep::test {

inline Normalisation no_change(int features) {
  return {Eigen::ArrayXf::Zero(features), Eigen::ArrayXf::Ones(features)};
}

inline std::shared_ptr<Model> random_model(const CopingNetSettings& settings, std::uint64_t seed = 1) {
  return std::make_shared<Model>(
      Model{CopingNet<float>(settings, seed),
            {no_change(node_features(settings)), no_change(edge_features(settings)), no_change(6), no_change(6)}});
}

/// A small message-passing network without a base guess.
inline CopingNetSettings message_passing(Encoding encoding, bool moves) {
  CopingNetSettings settings;
  settings.encoding = encoding;
  settings.processor = Processor::message_passing;
  settings.base = BaseGuess::none;
  settings.latent = 16;
  settings.steps = 2;
  settings.best_length = false;
  settings.moves = moves;
  return settings;
}

/// A small network for every valid combination of encoding, processor, base guess and couplings.
inline std::vector<CopingNetSettings> kinds_of_networks() {
  std::vector<CopingNetSettings> out;
  for (const Encoding encoding : {Encoding::paper, Encoding::paper_residual, Encoding::linear_system})
    for (const Processor processor : {Processor::factors, Processor::message_passing})
      for (const BaseGuess base :
           {BaseGuess::none, BaseGuess::extrapolation, BaseGuess::regression, BaseGuess::subspace}) {
        if (processor == Processor::factors && encoding != Encoding::linear_system) continue;
        CopingNetSettings settings;
        settings.encoding = encoding;
        settings.processor = processor;
        settings.base = base;
        settings.base_size = 3;
        settings.latent = 16;
        settings.steps = 2;
        out.push_back(settings);
        if (processor != Processor::factors) continue;
        settings.couplings = Couplings::all;
        out.push_back(settings);
      }
  return out;
}

}  // namespace rodsweep::test
