// SPDX-License-Identifier: Apache-2.0
// The image files of the frames of an animation, and whether an earlier run has written them.
#ifndef QUINTET_OUTPUT_FRAME_FILES_H
#define QUINTET_OUTPUT_FRAME_FILES_H

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "job/provenance.h"
#include "output/plan.h"

namespace quintet::output {

// A frame of an animation, for the report.
struct FrameFiles {
  std::uint64_t frame = 0;
  std::vector<std::filesystem::path> files;
  double seconds = 0;    // of rendering; 0 if written before
  bool written = false;  // by an earlier run
};

// Names of the files of a frame.
std::vector<std::filesystem::path> frameFiles(const OutputPlan& plan, std::uint64_t frame);

// Identifies the request and the frame: two complete frames with the same hash have the same pixels, except for renders
// that end by time. It is the metadata FrameHash of the images.
std::string frameHash(const OutputPlan& plan, const job::Provenance& frame);
inline constexpr const char* kFrameHashKey = "FrameHash";

// Whether all files of the frame exist and have its hash. Radiance HDR files have no metadata, so they are never known
// to belong to the frame. `frame`: Observer::isFrameWritten.
bool isFrameWritten(const OutputPlan& plan, const job::Provenance& frame);

}  // namespace quintet::output
#endif
