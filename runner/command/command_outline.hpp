// What may be typed: commands, options and arguments with their descriptions, read off the parser. From it completion
// and the manual are made, so that neither can differ from what the program takes.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace rodsweep {

struct ArgumentOutline {
  std::vector<std::string> names;  ///< "-o", "--output"; empty: given by its place
  std::string value;               ///< the word for its value: FILE, SECONDS; empty: none
  std::string description;
  bool required = false;
  bool optional_value = false;  ///< of an option
  bool repeated = false;
};

struct CommandOutline {
  std::string name;
  std::string
      description;  ///< paragraphs, lines broken; so is the footer, whose indented lines are to stay as they are
  std::string footer;
  std::vector<ArgumentOutline> options;
  std::vector<ArgumentOutline> arguments;  ///< in their order
  std::vector<CommandOutline> commands;
};

CommandOutline outline_of(const CLI::App& command);

}  // namespace rodsweep
