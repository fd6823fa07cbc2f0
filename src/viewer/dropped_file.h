// SPDX-License-Identifier: Apache-2.0
// What a file that the user drops on the window, or opens, is for.
#ifndef QUINTET_VIEWER_DROPPED_FILE_H
#define QUINTET_VIEWER_DROPPED_FILE_H

#include <filesystem>

namespace quintet::viewer {

enum class FileUse {
  scene,        // .gltf, .glb, .scene.toml
  program,      // a folder with program.toml or one *.rt.glsl file; program.toml; *.rt.glsl
  environment,  // .hdr, .exr
  reference,    // .png, .jpg, .jpeg, .webp: an image to compare with
  explanation,  // .json: an explanation of a pixel to compare with
  unknown,
};

// By the name, and for folders by their content. Letter case does not matter.
FileUse useOfFile(const std::filesystem::path& path);

}  // namespace quintet::viewer
#endif
