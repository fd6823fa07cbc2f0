// SPDX-License-Identifier: Apache-2.0
// Joins parts of a render, made by any number of processes, to the film that one process would have made.
#ifndef QUINTET_JOB_MERGE_H
#define QUINTET_JOB_MERGE_H

#include <filesystem>
#include <string>
#include <vector>

#include "job/observer.h"
#include "job/result.h"

namespace quintet::job {

// Adds the films one after the other, block by block, so that only their sum is in memory, for any number of them. Facts
// in which the parts may differ (device, exposure, …) are joined or taken from the part with the first samples, and
// reported as notes. Throws FileError for a part that cannot be read, belongs to a different render, or shares samples
// with another part; Error if there are no samples at all. `commandLine` becomes that of the result, for metadata; empty
// keeps that of the first part. `maxMemory` of the sum: see render::readFilm; more is a MemoryError.
RenderResult merge(const std::vector<std::filesystem::path>& parts, Observer& observer,
                   const std::string& commandLine = {}, std::size_t maxMemory = 0);

// What the merged film lacks: "missing: samples 16–31"; empty if it is complete.
std::string missingText(const RenderResult& merged);

}  // namespace quintet::job
#endif
