// The keys of a PluginFile and of a PythonFile, for what is derived from them.
#pragma once

#include "runner/keys/key_table.hpp"
#include "runner/specs/plugin_file.hpp"

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
  KeyTable<Owner> table;
  table.required(
      file_key("library", FileKind::plugin, "shared library that exports rodsweep_plugin() (docs/extending.md)"),
      &Owner::library);
  table.optional(text_key("options", "text that the library receives").at_most(1000), &Owner::options);
  table.unbound(inputs_key());
  return table;
}

template <class Owner>
KeyTable<Owner> python_keys(FileKind kind) {
  KeyTable<Owner> table;
  table.required(file_key("file", kind, "Python file with a class Guess or Preconditioner (docs/own-guess.md)"),
                 &Owner::file);
  table.optional(text_key("options", "text that the class receives").at_most(1000), &Owner::options);
  table.optional(inputs_key(), &Owner::inputs);
  return table;
}

}  // namespace rodsweep
