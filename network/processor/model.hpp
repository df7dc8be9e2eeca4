// A trained COPINGNet: its weights and the units of its features.
#pragma once

#include "network/encoding/feature_encoder.hpp"
#include "network/processor/coping_net.hpp"

namespace rodsweep {

struct Model {
  CopingNet<float> net;
  FeatureScales scales;
};

}  // namespace rodsweep
