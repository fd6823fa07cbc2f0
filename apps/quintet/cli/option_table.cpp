// SPDX-License-Identifier: Apache-2.0
#include "cli/option_table.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "base/parse.h"

namespace quintet::cli {
namespace {

constexpr const char* kOptions = "Options";

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

}  // namespace quintet::cli
