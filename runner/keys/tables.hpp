// The tables of keys that the reader, the schema and the space of a sweep follow. Their rows are in runner/specs.
#pragma once

#include <vector>

#include "runner/keys/key.hpp"

namespace rodsweep {

/// The key of the whole job: an object whose `kind` determines its other keys.
const Key& job_key();

/// One object key per kind of guess, with its parameters.
const std::vector<Key>& guess_keys();

/// `label`, allowed in any entry of the list of guesses, beside its parameters or its sweep.
const Key& guess_label_key();

}  // namespace rodsweep
