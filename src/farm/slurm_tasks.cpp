// SPDX-License-Identifier: Apache-2.0
#include "farm/slurm_tasks.h"

#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "base/file.h"
#include "base/parse.h"
#include "base/text.h"
#include "farm/scripts.h"
#include "output/video/ffmpeg.h"

namespace quintet::farm {
namespace {

struct CommandOutput {
  std::string text;
  int status = -1;
};

// `command`: for the shell, without words from outside.
CommandOutput outputOf(const std::string& command) {
  CommandOutput output;
  std::FILE* const pipe = ::popen(command.c_str(), "re");
  if (!pipe) return output;
  std::array<char, 4096> buffer{};
  while (const std::size_t count = std::fread(buffer.data(), 1, buffer.size(), pipe))
    output.text.append(buffer.data(), count);
  const int status = ::pclose(pipe);
  output.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return output;
}

bool isNumber(std::string_view text) {
  return !text.empty() && text.size() < 20 && text.find_first_not_of("0123456789") == text.npos;
}

}  // namespace

void readTaskLines(std::string_view text, const std::string& renderJob, const std::string& mergeJob,
                   SlurmTasks& tasks) {
  for (const std::string& line : splitText(std::string(text), '\n')) {
    const std::vector<std::string> fields = splitText(line, '|');
    if (fields.size() != 3) continue;
    SlurmTask task{fields[1], fields[2] == "None assigned" ? "" : fields[2]};
    task.state = task.state.substr(0, task.state.find(' '));  // of jobs that were ended: "… by 1000"
    if (fields[0] == mergeJob) {
      if (!tasks.merge) tasks.merge = task;
      continue;
    }
    const std::vector<std::string> id = splitText(fields[0], '_');
    if (id.size() != 2 || id[0] != renderJob) continue;
    if (const auto index = parseNumber<std::size_t>(id[1])) tasks.tasks.try_emplace(*index, task);
  }
}

SlurmTasks querySlurm(const Plan& plan) {
  SlurmTasks tasks;
  const std::filesystem::path file = plan.folder / kJobsFile;
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) return tasks;
  std::string merge;
  for (const std::string& line : splitText(readTextFile(file), '\n')) {
    const std::vector<std::string> words = splitText(line, ' ');
    if (words.size() != 2 || !isNumber(words[1])) continue;
    if (words[0] == "tasks")
      tasks.arraySize = parseNumber<std::size_t>(words[1]).value_or(0);
    else
      (words[0] == "merge" ? merge : tasks.job) = words[1];
  }
  if (tasks.job.empty()) return tasks;
  if (output::findProgram("squeue").empty()) {
    tasks.problem = "squeue was not found, so the states of the jobs are unknown";
    return tasks;
  }
  const std::string jobs = merge.empty() ? tasks.job : tasks.job + "," + merge;
  // squeue forgets jobs some minutes after their end, and then fails for their ids if it knows no other of them.
  const CommandOutput queue = outputOf(fmt::format("squeue -h -r -t all -j {} -o '%i|%T|%N' 2>&1", jobs));
  readTaskLines(queue.text, tasks.job, merge, tasks);
  if (queue.status != 0 && queue.text.find("Invalid job id") == queue.text.npos)
    tasks.problem = fmt::format("squeue failed: {}", printable(queue.text.substr(0, queue.text.find('\n'))));
  if (!output::findProgram("sacct").empty())
    readTaskLines(outputOf(fmt::format("sacct -n -P -X -j {} -o JobID,State,NodeList 2> /dev/null", jobs)).text,
                  tasks.job, merge, tasks);
  return tasks;
}

}  // namespace quintet::farm
