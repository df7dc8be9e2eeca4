// Contact in a job: the keys of `scene.contact`.
#pragma once

#include "runner/job/key_table.hpp"
#include "solver/scene/contact_settings.hpp"

namespace rodsweep {

KeyTable<ContactSettings> contact_keys();

}  // namespace rodsweep
