// SPDX-License-Identifier: Apache-2.0
// Names of the files that a render writes: one for each frame and each output.
#ifndef QUINTET_OUTPUT_FILE_NAMES_H
#define QUINTET_OUTPUT_FILE_NAMES_H

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace quintet::output {

// "name####.png", "name.%04d.png": the file name contains a pattern for the frame number: one or more #, as many as the
// number has digits at least, or %d, or %0Nd. Throws UsageError for two patterns.
bool hasFramePattern(const std::filesystem::path& file);

// "out.png" with output "normal" and frame 7 becomes "out.normal.0007.png"; "a_###.png" becomes "a_normal_007.png".
// An empty `output` adds no name. Without a frame no number is added, and a pattern stays as it is.
std::filesystem::path fileName(const std::filesystem::path& file, const std::string& output,
                               std::optional<std::uint64_t> frame);

// The name of a program's image in the current folder: "ao.png", "sphere.png" for the program lessons/sphere.rt.glsl.
std::filesystem::path defaultImage(const std::string& program);

}  // namespace quintet::output
#endif
