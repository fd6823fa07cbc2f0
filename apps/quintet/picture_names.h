// Names of the files that a rendering writes: one for each frame and each output.
#ifndef QUINTET_APP_PICTURE_NAMES_H
#define QUINTET_APP_PICTURE_NAMES_H

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace quintet::app {

// "name.%04d.png": the file name has the place for the frame's number, %d or %0Nd. Throws UsageError for two.
bool hasFramePlace(const std::filesystem::path& file);

// "out.png" with output "normal" and frame 7: "out.normal.0007.png"; "a_%03d.png": "a_normal_007.png".
// Empty `output`: without; no frame: without, and a place for it stays as it is.
std::filesystem::path pictureName(const std::filesystem::path& file, const std::string& output,
                                  std::optional<std::uint32_t> frame);

}  // namespace quintet::app
#endif
