// SPDX-License-Identifier: Apache-2.0
// What `quintet info` prints about devices and files, as text for people or as one JSON object on one line.
#ifndef QUINTET_OUTPUT_INFO_H
#define QUINTET_OUTPUT_INFO_H

#include <filesystem>
#include <string>

#include "scene/load_options.h"

namespace quintet::output {

// Every Vulkan device, usable or not, with the reason.
std::string devicesInfo(bool json);

// A scene, an image or a film, distinguished by name and content. `options`: of scenes. Throws FileError.
std::string fileInfo(const std::filesystem::path& file, bool json, const scene::LoadOptions& options = {});

// Counts, bounds, images, lights, cameras; what of the file is used, unused, repaired and ignored.
std::string sceneInfo(const std::filesystem::path& file, bool json, const scene::LoadOptions& options = {});

}  // namespace quintet::output
#endif
