// Where the elements of an accessor lie: their sizes and strides (glTF 2.0 section 3.6.2.4), and that they are inside
// their buffer views. What they are as numbers is gltf_accessor.h's.
#ifndef QUINTET_SCENE_GLTF_ACCESSOR_LAYOUT_H
#define QUINTET_SCENE_GLTF_ACCESSOR_LAYOUT_H

#include <cstddef>

#include "scene/gltf_document.h"

namespace quintet::scene {

// Bytes.
std::size_t componentSize(int componentType);
std::size_t elementSize(const tinygltf::Accessor&);                // matrix columns start at multiples of four
std::size_t strideOf(const Document&, const tinygltf::Accessor&);  // of one with a buffer view

// Every accessor, used or not: inside its view, stride not below the element size, sparse parts inside
// theirs. Called once by readDocument; throws FileError.
void checkAccessors(const Document&);

}  // namespace quintet::scene
#endif
