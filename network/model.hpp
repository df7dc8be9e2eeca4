// A trained COPINGNet: its weights and the units of its features.
#pragma once

#include "network/coping_net.hpp"
#include "network/feature_encoder.hpp"

namespace rodsweep {

struct Model {
  CopingNet<float> net;
  FeatureScales scales;
};

}  // namespace rodsweep
