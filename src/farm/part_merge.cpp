// SPDX-License-Identifier: Apache-2.0
#include "farm/part_merge.h"

#include <filesystem>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "farm/part_check.h"
#include "job/merge.h"

namespace quintet::farm {

job::RenderResult mergeParts(const Plan& plan, bool partial, job::Observer& observer, const std::string& commandLine,
                             std::size_t maxMemory) {
  observer.stage("checking parts");
  const std::vector<PartCheck> checks = checkParts(plan, CheckDepth::header);
  requireUsable(plan, checks, unexpectedFiles(plan), partial);
  std::vector<std::filesystem::path> films;
  for (std::size_t part = 0; part < checks.size(); ++part)
    if (checks[part].state == PartState::done) films.push_back(partFile(plan, part));
  if (films.empty()) throw Error(fmt::format("{}: no part is done", (plan.folder / kPlanFile).string()));
  try {
    return job::merge(films, observer, commandLine, maxMemory);
  } catch (const FileError&) {
    // A part is damaged behind its header. The others are verified, too, so that one error names all of them.
    requireUsable(plan, checkParts(plan, CheckDepth::content), {}, partial);
    throw;
  }
}

}  // namespace quintet::farm
