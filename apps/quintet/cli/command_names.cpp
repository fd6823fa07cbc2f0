// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <utility>

#include "cli/command.h"

namespace quintet::cli {

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
