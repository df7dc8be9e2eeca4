// The keys of a PluginFile and of a PythonFile, for what is derived from them.
#pragma once

#include "runner/job/key_table.hpp"
#include "runner/job/plugin_file.hpp"

namespace rodsweep {

template <class Owner>
KeyTable<Owner> plugin_keys() {
  KeyTable<Owner> table;
  table.required(
      file_key("library", FileKind::plugin, "shared library that exports rodsweep_plugin() (docs/extending.md)"),
      &Owner::library);
  table.optional(text_key("options", "text that the library receives").at_most(1000), &Owner::options);
  return table;
}

template <class Owner>
KeyTable<Owner> python_keys(FileKind kind) {
  KeyTable<Owner> table;
  table.required(file_key("file", kind, "Python file with a class Guess or Preconditioner (docs/own-guess.md)"),
                 &Owner::file);
  table.optional(text_key("options", "text that the class receives").at_most(1000), &Owner::options);
  return table;
}

}  // namespace rodsweep
