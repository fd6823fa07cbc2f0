// SPDX-License-Identifier: Apache-2.0
#include "farm/scripts.h"

#include <algorithm>
#include <cassert>
#include <iterator>
#include <map>
#include <span>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "base/embedded.h"
#include "base/error.h"
#include "base/file.h"
#include "base/parse.h"
#include "base/text.h"

namespace quintet {
std::span<const EmbeddedFile> embeddedFarmScripts();  // the folder scripts/
}

namespace quintet::farm {
namespace {

// What the placeholders of the scripts stand for. A line whose placeholder has no values is omitted; with several, it is
// repeated.
using Placeholders = std::map<std::string, std::vector<std::string>>;

std::string scriptTemplate(std::string_view name) {
  const auto files = embeddedFarmScripts();
  const auto found = std::ranges::find(files, name, &EmbeddedFile::path);
  assert(found != files.end());
  return std::string(found->data);
}

// The line with values for its placeholders "@NAME@", one line for each value of the last one.
std::vector<std::string> filledLines(const std::string& line, const Placeholders& values) {
  const std::size_t begin = line.find('@'), end = line.find('@', begin + 1);
  if (begin == line.npos || end == line.npos) return {line};
  const auto found = values.find(line.substr(begin + 1, end - begin - 1));
  std::vector<std::string> lines;
  if (found == values.end()) {  // the shell's "$@"
    for (const std::string& rest : filledLines(line.substr(begin + 1), values))
      lines.push_back(line.substr(0, begin + 1) + rest);
    return lines;
  }
  for (const std::string& value : found->second)
    for (const std::string& rest : filledLines(line.substr(end + 1), values))
      lines.push_back(line.substr(0, begin) + value + rest);
  return lines;
}

std::string filled(std::string_view name, const Placeholders& values) {
  std::string text;
  std::vector<std::string> lines = splitText(scriptTemplate(name), '\n');
  lines.pop_back();
  for (const std::string& line : lines) {
    if (line.starts_with("# SPDX") || line.starts_with("# shellcheck")) continue;  // of our sources
    for (const std::string& one : filledLines(line, values)) text += one + "\n";
  }
  return text;
}

void requireOneLine(const std::string& text) {
  if (text.find_first_of("\r\n") != text.npos)
    throw UsageError(fmt::format("'{}' has a line break, which an option of sbatch cannot have", printable(text)));
}

// For a line "#SBATCH OPTION": sbatch splits it at spaces outside of quotes, and knows comments and backslashes.
std::string sbatchQuoted(const std::string& option) {
  requireOneLine(option);
  if (option.find_first_of(" \t\"'#\\") == option.npos) return option;
  std::string quoted = "\"";
  for (const char c : option) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + '"';
}

std::vector<std::string> ifSet(const std::string& text) {
  return text.empty() ? std::vector<std::string>{} : std::vector{sbatchQuoted(text)};
}

// For bash.
std::string quoted(const std::filesystem::path& path) { return shellQuoted(path.string()); }

Placeholders placeholders(const Plan& plan, const ScriptOptions& options) {
  const auto number = [](std::size_t value) { return std::vector{fmt::format("{}", value)}; };
  const std::size_t tasks = taskCount(plan, options);
  std::vector<std::string> further;
  std::ranges::transform(options.sbatch, std::back_inserter(further), sbatchQuoted);
  return {{"PROGRAM", {quoted(options.program)}},
          {"PLAN", {quoted(plan.folder / kPlanFile)}},
          {"PARALLEL", {quoted(plan.folder / "parallel.sh")}},
          {"JOBS", {kJobsFile}},
          {"RETRIES", number(options.retries)},
          {"PARTS", number(plan.parts.size())},
          {"LAST_PART", number(plan.parts.size() - 1)},
          {"TASKS", number(tasks)},
          {"LAST_TASK", number(tasks - 1)},
          {"PARTITION", ifSet(options.partition)},
          {"TIME", ifSet(options.time)},
          {"MEMORY", ifSet(options.memory)},
          {"OPTION", std::move(further)}};
}

}  // namespace

std::size_t taskCount(const Plan& plan, const ScriptOptions& options) {
  return std::min(plan.parts.size(), std::max<std::size_t>(options.tasks, 1));
}

std::vector<std::pair<std::string, std::string>> scripts(const Plan& plan, const ScriptOptions& options) {
  Placeholders values = placeholders(plan, options);
  values["RUN_PART"] = {filled("run_part.sh", values)};
  std::vector<std::pair<std::string, std::string>> texts;
  for (const char* name : {"render.sbatch", "merge.sbatch", "submit.sh", "parallel.sh"})
    texts.emplace_back(name, filled(name, values));
  return texts;
}

void writePlan(const Plan& plan, const ScriptOptions& options, bool overwrite) {
  const std::filesystem::path file = plan.folder / kPlanFile;
  std::error_code failed;
  if (std::filesystem::exists(file, failed) && !overwrite) {
    std::string id;
    try {
      id = planId(readPlan(file));
    } catch (const FileError&) {  // no plan, or a broken one
    }
    if (id != planId(plan)) throw FileError(file, "is a different plan", Remedy::overwrite);
  }
  const std::vector<std::pair<std::string, std::string>> texts = scripts(plan, options);
  for (const std::filesystem::path& folder : planFolders(plan)) {
    std::filesystem::create_directories(folder, failed);
    if (failed) throw FileError(folder, "cannot be created: " + failed.message());
  }
  for (const auto& [name, text] : texts) {
    writeFile(plan.folder / name, text);
    if (name.ends_with(".sh")) std::filesystem::permissions(plan.folder / name, std::filesystem::perms(0755), failed);
  }
  writeFile(file, planText(plan));
}

}  // namespace quintet::farm
