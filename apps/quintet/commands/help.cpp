// SPDX-License-Identifier: Apache-2.0
// `quintet help`: the help of a command; for packages, also its man page and the completions of shells.
#include "commands/help.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/file.h"
#include "base/suggestion.h"
#include "base/text.h"
#include "base/wrap.h"
#include "cli/help_text.h"
#include "cli/parser.h"
#include "cli/values.h"
#include "commands/completion.h"
#include "commands/manual.h"

namespace quintet::cli {
namespace {

struct HelpOptions {
  std::vector<std::string> command;  // one word, or two
  bool man = false;
  bool list = false;
  std::optional<std::string> completion;
};

OptionTable declareHelp(HelpOptions& options) {
  std::vector<std::string> names;
  for (const Command& command : commands()) names.push_back(commandKey(command.name));
  OptionTable table("help", "Prints the help of a command, or the list of commands.");
  table.add({{.names = "COMMAND",
              .help = "Name of a command, also as one word (farm-plan); without it, the list of all",
              .target = &options.command,
              .candidates = {.names = names}}});
  table.add("For packages",
            {{.names = "--man", .help = "Print the man page of COMMAND, or of quintet", .target = &options.man},
             {.names = "--completion",
              .value = "SHELL",
              .help = "Print the completions for a shell: bash, zsh or fish",
              .target = &options.completion,
              .candidates = {.names = {"bash", "zsh", "fish"}}},
             {.names = "--commands", .help = "Print the names of the commands", .target = &options.list}});
  table.addExamples({
      {"quintet help render", "the same as quintet render --help"},
      {"quintet help --man render | man -l -", "the man page"},
      {"source <(quintet help --completion bash)", "completions in this shell"},
  });
  return table;
}

OptionTable tableOf(const std::vector<std::string>& words) {
  if (const NamedCommand found = commandNamed(words); found.command && found.words == words.size())
    return found.command->options();
  throw UsageError(unknownCommandText(words.front(), words.size() > 1 ? words[1] : ""));
}

std::string completionFor(const std::string& shell) {
  switch (parseChoice("--completion", shell, {"bash", "zsh", "fish"})) {
    case 0: return bashCompletion();
    case 1: return zshCompletion();
    default: return fishCompletion();
  }
}

std::string commandNames() {
  std::string text;
  for (const Command& command : commands()) text += fmt::format("{}\n", commandKey(command.name));
  return text;
}

}  // namespace

std::string unknownCommandText(std::string_view name, std::string_view second) {
  if (const std::vector<std::string> group = commandWords(name); !group.empty())
    return fmt::format(
        "{}; commands of '{}': {}",
        second.empty() ? fmt::format("the command after '{}' is missing", name)
                       : fmt::format("unknown command '{} {}'{}", name, printable(second), suggestion(second, group)),
        name, fmt::join(group, ", "));
  std::vector<std::string> names = commandWords();
  names.insert(names.begin(), {"--help", "--version"});
  return fmt::format("unknown {} '{}'{}; 'quintet --help' lists the commands",
                     name.starts_with('-') ? "option" : "command", printable(name), suggestion(name, names));
}

std::string groupText(std::string_view group) {
  const std::size_t width = helpWidth();
  std::string text = fmt::format("Usage: quintet {} COMMAND [OPTIONS]\n\nCommands:\n", group);
  for (const Command& command : commands())
    if (command.name.starts_with(std::string(group) + " "))
      text += twoColumns(fmt::format("  {}", command.name), command.summary, 16, width);
  return text + fmt::format("\n  quintet {} COMMAND --help      options and examples of a command\n", group);
}

std::string overviewText() {
  const std::size_t width = helpWidth();
  std::string text =
      wrapped("Quintet: five shaders in, image out. A path tracer for glTF scenes on Vulkan ray tracing.", width, 0) +
      "\n\nUsage: quintet COMMAND [OPTIONS]\n\nCommands:\n";
  for (const Command& command : commands())
    text += twoColumns(fmt::format("  {}", command.name), command.summary, 12, width);
  return text +
         "\n  quintet COMMAND --help      options and examples of a command\n"
         "  quintet --version           version of Quintet\n\nExamples:\n" +
         examplesText({{"quintet render scene.glb", "scene.png, 64 samples per pixel"},
                       {"quintet render scene.glb -o out.exr --time 60", "as many samples as possible"},
                       {"quintet run ao", "a program on the built-in scene"},
                       {"quintet info", "the Vulkan devices"},
                       {"quintet compare out.png reference.png", "measures of their difference"}},
                      width);
}

OptionTable helpOptions() {
  HelpOptions options;
  return declareHelp(options).withoutTargets();
}

int helpCommand(Arguments arguments) {
  HelpOptions options;
  if (!parse(declareHelp(options), arguments)) return 0;
  if (options.man + options.list + options.completion.has_value() > 1)
    throw UsageError("--man, --completion and --commands exclude each other");
  const bool named = !options.command.empty();
  if ((named && (options.list || options.completion)) || options.command.size() > 2)
    throw UsageError(
        fmt::format("unexpected argument '{}'; see 'quintet help --help'", printable(options.command.back())));
  const bool isGroup = options.command.size() == 1 && !commandWords(options.command[0]).empty();
  if (options.completion)
    writeFile("-", completionFor(*options.completion));
  else if (options.list)
    writeFile("-", commandNames());
  else if (options.man)
    writeFile("-", named ? manualPage(tableOf(options.command)) : mainManualPage());
  else
    writeFile("-", isGroup ? groupText(options.command[0])
                   : named ? helpText(tableOf(options.command), helpWidth())
                           : overviewText());
  return 0;
}

}  // namespace quintet::cli
