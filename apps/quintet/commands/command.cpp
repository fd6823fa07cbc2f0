// SPDX-License-Identifier: Apache-2.0
#include "cli/command.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cli/option_table.h"

namespace quintet::cli {

std::span<const Command> commands() {
  static constexpr std::array kCommands{
      Command{"render", "render an image of a scene", renderCommand, renderOptions, true},
      Command{"merge", "join parts of a render", mergeCommand, mergeOptions},
      Command{"farm plan", "split a render for many machines", farmPlanCommand, farmPlanOptions},
      Command{"farm run", "render a part of a plan", farmRunCommand, farmRunOptions, true},
      Command{"farm merge", "verify and join the parts of a plan", farmMergeCommand, farmMergeOptions},
      Command{"farm status", "show which parts of a plan are done", farmStatusCommand, farmStatusOptions},
      Command{"run", "run a program: your own or a built-in one", runCommand, runOptions, true},
      Command{"view", "show a scene in a window, or run a scripted session", viewCommand, viewOptions, true},
      Command{"lab", "write shaders in a browser beside a live image", labCommand, labOptions},
      Command{"new", "create a program that renders at once", newCommand, newOptions},
      Command{"check", "compile and check programs, without rendering", checkCommand, checkOptions, true},
      Command{"explain", "explain a diagnostic and how to fix it", explainCommand, explainOptions},
      Command{"explain-pixel", "explain one sample of a pixel: its rays and what they contribute", explainPixelCommand,
              explainPixelOptions, true},
      Command{"find", "find samples that are not finite, and fireflies", findCommand, findOptions, true},
      Command{"info", "describe the devices, or a scene, image or film", infoCommand, infoOptions},
      Command{"compare", "measure the difference between two images", compareCommand, compareOptions},
      Command{"bench", "measure rays per second, and compare with minimal shaders", benchCommand, benchOptions, true},
      Command{"licenses", "print the licenses of Quintet and of the code that it contains", licensesCommand,
              licensesOptions},
      Command{"help", "print the help of a command", helpCommand, helpOptions},
  };
  return kCommands;
}

NamedCommand commandNamed(Arguments words) {
  const auto matches = [&](std::string_view name) {
    if (words.empty()) return std::size_t{0};
    if (name == words[0] || commandKey(name) == words[0]) return std::size_t{1};
    const std::size_t space = name.find(' ');
    const bool both = space != name.npos && words.size() > 1 && name.substr(0, space) == words[0] &&
                      name.substr(space + 1) == words[1];
    return std::size_t{both ? 2u : 0u};
  };
  for (const Command& command : commands())
    if (const std::size_t count = matches(command.name)) return {&command, count};
  return {};
}

std::string commandKey(std::string_view name) {
  std::string key(name);
  std::ranges::replace(key, ' ', '-');
  return key;
}

std::vector<std::string> commandWords() {
  std::vector<std::string> words;
  for (const Command& command : commands()) {
    std::string word(command.name.substr(0, command.name.find(' ')));
    if (std::ranges::find(words, word) == words.end()) words.push_back(std::move(word));
  }
  return words;
}

std::vector<std::string> commandWords(std::string_view group) {
  std::vector<std::string> words;
  for (const Command& command : commands())
    if (command.name.starts_with(std::string(group) + " ")) words.emplace_back(command.name.substr(group.size() + 1));
  return words;
}

std::vector<std::string> commandGroups() {
  std::vector<std::string> groups = commandWords();
  std::erase_if(groups, [](const std::string& word) { return commandWords(word).empty(); });
  return groups;
}

}  // namespace quintet::cli
