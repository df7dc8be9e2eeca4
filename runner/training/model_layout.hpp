// The layout of a model file: tables of its attributes and datasets, used to write and read it.
#pragma once

#include <array>
#include <utility>

#include "network/processor/model.hpp"
#include "runner/training/model_file.hpp"

namespace rodsweep {

/// Attributes of /data and /training.
struct CountPlace {
  const char *group, *name;
  std::int64_t ModelCard::*member;
};
inline constexpr std::array<CountPlace, 7> count_places{{
    {"/data", "training_simulations", &ModelCard::training_simulations},
    {"/data", "validation_simulations", &ModelCard::validation_simulations},
    {"/data", "training_examples", &ModelCard::training_examples},
    {"/data", "validation_examples", &ModelCard::validation_examples},
    {"/training", "planned_epochs", &ModelCard::planned_epochs},
    {"/training", "best_epoch", &ModelCard::best_epoch},
    {"/validation", "simulations", &ModelCard::ratio_simulations},
}};

/// Columns with one row per epoch.
struct EpochPlace {
  const char *path, *unit, *meaning;
  double Epoch::*member;
  bool optional = false;  ///< files of earlier versions lack it
};
inline constexpr std::array<EpochPlace, 5> epoch_places{{
    {"/training/training_loss", "1", "mean over the epoch's examples, while the weights changed",
     &Epoch::training_loss},
    {"/training/validation_loss", "1", "mean over the validation examples, at the end", &Epoch::validation_loss},
    {"/training/rate", "1", "step size of Adam in the last step", &Epoch::rate},
    {"/timing/epoch_s", "s", "wall time of the epoch, its validation included", &Epoch::seconds},
    {"/timing/epoch_processor_s", "s",
     "processor time of the epoch: that of rank 0 times the ranks, which do equal work", &Epoch::processor_seconds,
     true},
}};
inline constexpr const char* epoch_ratio_path = "/training/cg_ratio";

/// CG ratios of the best model.
struct RatioPlace {
  const char *path, *meaning;
  ValidationRatio::Ratios ModelCard::*member;
};
inline constexpr std::array<RatioPlace, 2> ratio_places{{
    {"/validation/cg_ratio", "CG iterations with the model over those from zero, mean over validation simulations",
     &ModelCard::cg_ratio},
    {"/validation/base_cg_ratio", "the same for the model's base guess alone", &ModelCard::base_cg_ratio},
}};

/// Columns with one row per scene type, if the validation simulations have several types.
struct ScenePlace {
  const char *path, *meaning;
  ValidationRatio::Ratios SceneRatios::*member;
};
inline constexpr const char* scene_types_path = "/validation/scenes/type";
inline constexpr std::array<ScenePlace, 2> scene_places{{
    {"/validation/scenes/cg_ratio",
     "CG iterations with the model over those from zero, mean over validation simulations of the scene",
     &SceneRatios::cg_ratio},
    {"/validation/scenes/base_cg_ratio", "the same for the model's base guess alone", &SceneRatios::base_cg_ratio},
}};

/// The names of the endings in the file.
inline constexpr std::array<std::pair<Ending, const char*>, 4> endings{
    {{Ending::none, "none"}, {Ending::complete, "complete"}, {Ending::early, "early"}, {Ending::diverged, "diverged"}}};

/// Scales of a quantity, and their size (0: the encoding has none).
struct ScalePlace {
  const char* folder;
  Normalisation FeatureScales::*member;
  int (*size)(const CopingNetSettings&);
};
inline constexpr std::array<ScalePlace, 4> scale_places{{
    {"/model/scales/nodes/", &FeatureScales::nodes, [](const CopingNetSettings& s) { return node_features(s); }},
    {"/model/scales/edges/", &FeatureScales::edges, [](const CopingNetSettings& s) { return edge_features(s); }},
    {"/model/scales/multipliers/", &FeatureScales::multipliers,
     [](const CopingNetSettings& s) { return is_guess(s) ? 6 : 0; }},
    {"/model/scales/moves/", &FeatureScales::moves, [](const CopingNetSettings& s) { return s.moves ? 6 : 0; }},
}};
inline int scale_size(const ScalePlace& place, const CopingNetSettings& settings) {
  return !has_scales(settings) ? 0 : place.size(settings);
}

}  // namespace rodsweep
