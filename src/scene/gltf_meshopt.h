// EXT_meshopt_compression: buffer views in meshoptimizer's vertex and index codecs.
#ifndef QUINTET_SCENE_GLTF_MESHOPT_H
#define QUINTET_SCENE_GLTF_MESHOPT_H

#include <span>
#include <string>
#include <vector>

#include "scene/gltf_document.h"

namespace quintet::scene {

// The decompressed bytes of `view` (which has the extension); `place` is the extension object's. Throws FileError.
FileBytes decodeMeshopt(const Document&, const tinygltf::BufferView& view,
                        std::span<const std::span<const std::byte>> buffers, const std::string& place);

}  // namespace quintet::scene
#endif
