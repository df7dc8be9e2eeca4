// Makes the guess that a COPINGNet corrects.
#pragma once

#include <memory>

#include "network/encoding/coping_net_settings.hpp"
#include "solver/guess/initial_guess.hpp"

namespace rodsweep {

std::unique_ptr<InitialGuess> base_guess(const CopingNetSettings& settings, const Scene& scene, int newton_iterations);

}  // namespace rodsweep
