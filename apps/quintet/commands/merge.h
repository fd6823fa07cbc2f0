// SPDX-License-Identifier: Apache-2.0
// A merged film becomes the files that were requested: what `merge` and `farm merge` do.
#ifndef QUINTET_COMMANDS_MERGE_H
#define QUINTET_COMMANDS_MERGE_H

#include <cstddef>
#include <filesystem>

#include "base/stopwatch.h"
#include "cli/console.h"
#include "job/result.h"
#include "output/plan.h"

namespace quintet::cli {

struct MergeOutput {
  output::OutputRequest output;
  std::filesystem::path firstPart;  // for messages
  bool partial = false;             // write the image even if samples are missing
  bool force = false;               // overwrite a film although its samples are lost
  bool json = false;
  std::size_t maxMemory = 0;  // as of scene::LoadOptions
};

// `clock`: started with the command. Returns the exit status.
int writeMerged(job::RenderResult result, const MergeOutput& options, Console& console, const Stopwatch& clock);

}  // namespace quintet::cli
#endif
