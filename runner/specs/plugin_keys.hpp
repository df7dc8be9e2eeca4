// The keys of a PluginFile and of a PythonFile, for what is derived from them.
#pragma once

#include "runner/keys/key_table.hpp"
#include "runner/specs/guess_spec.hpp"

namespace rodsweep {

/// Files that the user's code reads.
inline Key inputs_key() {
  return list_key("inputs",
                  "other files whose contents its results depend on, such as weights: a sweep is not continued with "
                  "changed ones",
                  file_key("inputs", FileKind::any, "a file"))
      .defaults_to(nlohmann::ordered_json::array())
      .unlabelled();
}

template <class Owner>
KeyTable<Owner> plugin_keys() {
  return KeyTable<Owner>()
      .required(
          file_key("library", FileKind::plugin, "shared library that exports rodsweep_plugin() (docs/extending.md)"),
          &Owner::library)
      .optional(text_key("options", "text that the library receives").at_most(1000), &Owner::options)
      .unbound(inputs_key());
}

template <class Owner>
KeyTable<Owner> python_keys(FileKind kind) {
  return KeyTable<Owner>()
      .required(file_key("file", kind, "Python file with a class Guess or Preconditioner (docs/own-guess.md)"),
                &Owner::file)
      .optional(text_key("options", "text that the class receives").at_most(1000), &Owner::options)
      .optional(inputs_key(), &Owner::inputs);
}

}  // namespace rodsweep
