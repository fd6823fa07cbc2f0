// Cameras and lights: glTF objects that a node places in the world.
#ifndef QUINTET_SCENE_GLTF_PLACEMENT_H
#define QUINTET_SCENE_GLTF_PLACEMENT_H

#include "scene/gltf_document.h"

namespace quintet::scene {

// Scale and mirroring of the node do not reach a camera: its frame is made rigid, viewing direction first.
Camera placeCamera(const Document&, int camera, const tinygltf::Node&, const mat4& worldFromNode);

// None for a light whose type is unknown (reported).
void placeLight(const Document&, int light, const tinygltf::Node&, const mat4& worldFromNode, Scene&);

// The rigid frame with the z axis and, as far as possible, the y axis of `m`; falls back to the identity's
// axes where those have no direction.
mat4 rigidFrame(const mat4& m);

}  // namespace quintet::scene
#endif
