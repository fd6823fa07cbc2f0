// SPDX-License-Identifier: Apache-2.0
#include "farm/status.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/parse.h"
#include "base/plural.h"
#include "base/text.h"
#include "farm/scripts.h"
#include "output/json_line.h"

namespace quintet::farm {
namespace {

using StatusJson = nlohmann::ordered_json;

const SlurmTask* taskOf(const Status& status, std::size_t part) {
  if (status.tasks == 0) return nullptr;
  const auto found = status.slurm.tasks.find(part % status.tasks);
  return found == status.slurm.tasks.end() ? nullptr : &found->second;
}

std::string describe(const SlurmTask& task) {
  return task.nodes.empty() ? task.state : fmt::format("{} on {}", task.state, task.nodes);
}

StatusJson taskJson(const SlurmTask& task) { return {{"state", task.state}, {"nodes", task.nodes}}; }

}  // namespace

std::array<std::size_t, kPartStates> Status::counts() const {
  std::array<std::size_t, kPartStates> counts{};
  for (const PartCheck& part : parts) ++counts[static_cast<std::size_t>(part.state)];
  return counts;
}

bool Status::complete() const { return counts()[0] == parts.size() && unexpected.empty(); }

Status readStatus(const Plan& plan, CheckDepth depth) {
  Status status{plan, checkParts(plan, depth), unexpectedFiles(plan), querySlurm(plan), 0};
  status.tasks = status.slurm.arraySize;
  for (const auto& [index, task] : status.slurm.tasks) status.tasks = std::max(status.tasks, index + 1);
  return status;
}

std::string statusText(const Status& status, std::size_t rows) {
  const auto counts = status.counts();
  std::string text = fmt::format("{}: {} of {} done", (status.plan.folder / kPlanFile).string(), counts[0],
                                 counted(status.parts.size(), "part"));
  for (std::size_t s = 1; s < kPartStates; ++s)
    if (counts[s] > 0) text += fmt::format(", {} {}", counts[s], partStateName(static_cast<PartState>(s)));
  text += "\n";
  std::size_t shown = 0;
  for (std::size_t part = 0; part < status.parts.size(); ++part) {
    const PartCheck& check = status.parts[part];
    if (check.state == PartState::done || shown++ >= rows) continue;
    const SlurmTask* task = taskOf(status, part);
    const std::string detail = fmt::format("{}{}{}", task ? describe(*task) : "",
                                           task && !check.problem.empty() ? "; " : "", printable(check.problem));
    text += detail.empty()
                ? fmt::format("  {:<28} {}\n", partName(status.plan, part), partStateName(check.state))
                : fmt::format("  {:<28} {:<14} {}\n", partName(status.plan, part), partStateName(check.state), detail);
  }
  if (shown > rows) text += fmt::format("  and {} more\n", shown - rows);
  for (const std::filesystem::path& file : status.unexpected)
    text += fmt::format("  {}: is not a part of this plan\n", printable(file.string()));
  const SlurmTasks& slurm = status.slurm;
  if (!slurm.problem.empty()) text += "  " + slurm.problem + "\n";
  if (slurm.merge) text += fmt::format("  merge: {}\n", describe(*slurm.merge));
  return text;
}

std::string statusJson(const Status& status) {
  const auto counts = status.counts();
  StatusJson states = StatusJson::object(), parts = StatusJson::array(), unexpected = StatusJson::array();
  for (std::size_t s = 0; s < kPartStates; ++s)
    states[std::string(partStateName(static_cast<PartState>(s)))] = counts[s];
  for (std::size_t part = 0; part < status.parts.size(); ++part) {
    const PartCheck& check = status.parts[part];
    if (check.state == PartState::done) continue;
    StatusJson entry{{"part", part},
                     {"first", status.plan.parts[part].first},
                     {"last", status.plan.parts[part].last},
                     {"state", partStateName(check.state)},
                     {"problem", check.problem}};
    if (const SlurmTask* task = taskOf(status, part)) entry["slurm"] = taskJson(*task);
    parts.push_back(std::move(entry));
  }
  for (const std::filesystem::path& file : status.unexpected) unexpected.push_back(file.string());
  StatusJson json{{"plan", planId(status.plan)},         {"version", status.plan.version},
                  {"image", status.plan.image.string()}, {"kind", partKindName(status.plan.kind)},
                  {"parts", status.parts.size()},        {"complete", status.complete()},
                  {"states", std::move(states)},         {"notDone", std::move(parts)},
                  {"unexpected", std::move(unexpected)}};
  if (!status.slurm.job.empty()) {
    StatusJson slurm{{"job", status.slurm.job}, {"problem", status.slurm.problem}};
    if (status.slurm.merge) slurm["merge"] = taskJson(*status.slurm.merge);
    json["slurm"] = std::move(slurm);
  }
  return output::jsonLine(json);
}

}  // namespace quintet::farm
