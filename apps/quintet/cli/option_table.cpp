// SPDX-License-Identifier: Apache-2.0
#include "cli/option_table.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "base/parse.h"

namespace quintet::cli {
namespace {

constexpr const char* kOptions = "Options";

// The option with this name; null if there is none.
const Option* findOption(const std::vector<Option>& options, const std::string& name) {
  const auto found = std::ranges::find_if(options, [&](const Option& option) {
    const std::vector<std::string> names = option.nameList();
    return std::ranges::find(names, name) != names.end();
  });
  return found == options.end() ? nullptr : &*found;
}

}  // namespace

bool Option::isList() const {
  return std::holds_alternative<std::vector<std::string>*>(target) ||
         std::holds_alternative<std::vector<std::filesystem::path>*>(target);
}

std::vector<std::string> Option::nameList() const { return splitText(names, ','); }

std::string Option::longName() const { return nameList().back(); }

std::string Option::valueForm() const {
  if (value.empty()) return "";
  return withoutValue.empty() ? " " + value : "[=" + value + "]";
}

OptionTable::OptionTable(std::string command, std::string description)
    : command_(std::move(command)), description_(std::move(description)) {
  add({{.names = "-h,--help", .help = "Print this help and exit"}});
}

void OptionTable::add(const std::string& group, std::vector<Option> options) {
  for (Option& option : options) {
    if (option.isArgument()) {
      arguments_.push_back(std::move(option));
      continue;
    }
    auto found = std::ranges::find(groups_, group, &OptionGroup::name);
    if (found == groups_.end()) found = groups_.insert(groups_.end(), {group, {}});
    found->options.push_back(std::move(option));
  }
}

void OptionTable::add(std::vector<Option> options) { add(kOptions, std::move(options)); }

void OptionTable::addExamples(std::vector<Example> examples) {
  std::ranges::move(examples, std::back_inserter(examples_));
}

std::vector<Option> OptionTable::options() const {
  std::vector<Option> all;
  for (const OptionGroup& group : groups_) all.insert(all.end(), group.options.begin(), group.options.end());
  return all;
}

std::string OptionTable::usage() const {
  std::string text = program() + " [OPTIONS]";
  for (const Option& argument : arguments_) {
    const std::string form = argument.names + (argument.isList() ? "..." : "");
    text += argument.required ? " " + form : " [" + form + "]";
  }
  return text;
}

OptionTable OptionTable::withoutTargets() && {
  const auto clear = [](Option& option) { std::visit([](auto& target) { target = {}; }, option.target); };
  std::ranges::for_each(arguments_, clear);
  for (OptionGroup& group : groups_) std::ranges::for_each(group.options, clear);
  help_ = nullptr;
  return std::move(*this);
}

std::vector<std::string> selectArguments(const OptionTable& table, const OptionTable& wanted,
                                         std::span<const std::string> arguments) {
  const std::vector<Option> all = table.options(), chosen = wanted.options();
  std::vector<std::string> selected;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string& argument = arguments[i];
    if (argument == "--") break;
    if (argument.size() < 2 || argument[0] != '-') continue;
    const bool isLong = argument[1] == '-';
    const std::string name = isLong ? argument.substr(0, argument.find('=')) : argument.substr(0, 2);
    const Option* option = findOption(all, name);
    if (!option) continue;
    // The value is in the argument, or is the next one.
    const bool separate = !option->isFlag() && option->withoutValue.empty() && argument == name;
    const bool isChosen = findOption(chosen, name) != nullptr;
    if (isChosen) selected.push_back(argument);
    if (separate && ++i < arguments.size() && isChosen) selected.push_back(arguments[i]);
  }
  return selected;
}

}  // namespace quintet::cli
