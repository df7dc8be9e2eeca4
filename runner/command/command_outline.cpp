#include "runner/command/command_outline.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>

namespace rodsweep {
namespace {

ArgumentOutline outline_of(const CLI::Option& option) {
  ArgumentOutline outline;
  outline.description = option.get_description();
  outline.required = option.get_required();
  outline.repeated = option.get_expected_max() > 1;
  if (option.get_positional()) {
    outline.value = option.get_name(true);
    return outline;
  }
  for (const std::string& name : option.get_snames()) outline.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) outline.names.push_back("--" + name);
  if (option.get_type_size() == 0) return outline;
  outline.value = option.get_type_name();
  outline.value.resize(std::min(outline.value.size(), outline.value.find(':')));  // what a check adds
  outline.optional_value = option.get_expected_min() == 0;
  if (outline.optional_value && outline.value.rfind('[', 0) == 0)  // as the help shows it
    outline.value = outline.value.substr(1, outline.value.size() - 2);
  return outline;
}

}  // namespace

CommandOutline outline_of(const CLI::App& command) {
  CommandOutline outline{command.get_name(), command.get_description(), command.get_footer(), {}, {}, {}};
  for (const CLI::Option* option : command.get_options())
    (option->get_positional() ? outline.arguments : outline.options).push_back(outline_of(*option));
  for (const CLI::App* inner : command.get_subcommands({})) outline.commands.push_back(outline_of(*inner));
  return outline;
}

}  // namespace rodsweep
