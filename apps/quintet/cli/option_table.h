// SPDX-License-Identifier: Apache-2.0
// The options of a command as data. One table serves the parser, --help, the man page and the completions of shells
// (cli/parser.h, cli/help_text.h, commands/manual.h, commands/completion.h).
#ifndef QUINTET_CLI_OPTION_TABLE_H
#define QUINTET_CLI_OPTION_TABLE_H

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace quintet::cli {

// What a value can be, for completions.
struct Candidates {
  std::vector<std::string> names = {};       // complete or typical values
  std::vector<std::string> extensions = {};  // of files, without the dot; "*" means any file
  bool folders = false;                      // folders are values, too
};

// An option, or an argument without a name.
struct Option {
  // Where the value goes. A target is left unchanged if the option is not given. Of several occurrences, the last one counts;
  // lists collect the values of all.
  using Target = std::variant<std::monostate, bool*, int*, std::string*, std::optional<std::string>*,
                              std::filesystem::path*, std::vector<std::string>*, std::vector<std::filesystem::path>*>;

  std::string names = {};  // "-o,--output"; without a dash it is an argument: "SCENE"
  std::string value = {};  // form of the value, for example "FILE"; empty for a flag (bool*) and for arguments
  std::string help = {};   // without line breaks
  Target target = {};
  std::string withoutValue =
      {};  // what `--name` means if the value is optional, as in `--name=VALUE`; empty if it is not
  Candidates candidates = {};
  bool required = false;  // of an argument: only for the line "Usage"; the command reports that it is missing
  char delimiter = 0;     // separates the values of a list, besides repeating the option; 0 disables it
  int min = 0, max = 0;   // range of an int

  bool isArgument() const { return !names.starts_with('-'); }
  bool isFlag() const { return !isArgument() && value.empty(); }
  bool isList() const;
  std::vector<std::string> nameList() const;  // "-o", "--output"
  std::string longName() const;               // "--output"; the last name if none is long
  std::string valueForm() const;              // after the name: "", " FILE", or "[=FILE]" if the value is optional
};

struct OptionGroup {
  std::string name;
  std::vector<Option> options;
};

struct Example {
  std::string command;    // a line for a shell
  std::string text = {};  // what it does; may be empty
};

class OptionTable {
 public:
  // `command`: for example "render"
  OptionTable(std::string command, std::string description);

  // Appends arguments, and options to the group of this name, which may exist.
  void add(const std::string& group, std::vector<Option> options);
  void add(std::vector<Option> options);  // to the group "Options"
  void addExamples(std::vector<Example> examples);
  // The command handles -h and --help: they set this target instead of printing the help.
  void redirectHelp(bool* target) { help_ = target; }
  bool* redirectedHelp() const { return help_; }  // null if --help prints the help

  const std::string& command() const { return command_; }
  std::string program() const { return "quintet " + command_; }
  const std::string& description() const { return description_; }
  const std::vector<Option>& arguments() const { return arguments_; }
  const std::vector<OptionGroup>& groups() const { return groups_; }  // with --help
  const std::vector<Example>& examples() const { return examples_; }
  std::vector<Option> options() const;  // of all groups
  std::string usage() const;            // "quintet render [OPTIONS] SCENE"

  // The table without targets, which can outlive them.
  OptionTable withoutTargets() &&;

 private:
  std::string command_, description_;
  std::vector<Option> arguments_;
  std::vector<OptionGroup> groups_;
  std::vector<Example> examples_;
  bool* help_ = nullptr;
};

// Those of the arguments of a command line that are options of `wanted`, with their values, in their order. `table` has all
// options of the command line, which it can parse.
std::vector<std::string> selectArguments(const OptionTable& table, const OptionTable& wanted,
                                         std::span<const std::string> arguments);

}  // namespace quintet::cli
#endif
