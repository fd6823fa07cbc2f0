// SPDX-License-Identifier: Apache-2.0
// Writes the files of a plan from a result: PNG, OpenEXR with layers, Radiance HDR, or the film itself.
#ifndef QUINTET_OUTPUT_WRITE_H
#define QUINTET_OUTPUT_WRITE_H

#include <filesystem>
#include <string>
#include <vector>

#include "job/observer.h"
#include "job/result.h"
#include "output/plan.h"

namespace quintet::output {

struct WrittenFile {
  std::filesystem::path path;  // "-": standard output
  std::string toneMap;         // empty for linear values and films
};

// Each file replaces an existing one in one step. With OutputRequest::everyFrame, names get the number of the result's
// frame; a result that is not a frame has number 0 if the name has a pattern, and no number otherwise. Throws FileError.
std::vector<WrittenFile> writeOutputs(const OutputPlan& plan, const job::RenderResult& result, job::Observer& observer);

// The plan's first image as a PNG file shows it, with exposure and tone map, but with 8 bits and without alpha.
io::Image displayImage(const OutputPlan& plan, const job::FilmView& film);

// Adds the files of one more frame. A file that was written again is listed once.
void addWritten(std::vector<WrittenFile>& files, const std::vector<WrittenFile>& more);

// Throws FileError if the plan's film would lose samples that its file holds (job::rejectLoss, also for
// `maxMemory`).
void checkFilmLoss(const OutputPlan& plan, const job::RenderResult& result, std::size_t maxMemory = 0);

}  // namespace quintet::output
#endif
