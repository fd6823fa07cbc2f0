// SPDX-License-Identifier: Apache-2.0
// What the window shows of a scene, independent of the session that owns the scene.
#ifndef QUINTET_VIEWER_SCENE_OUTLINE_H
#define QUINTET_VIEWER_SCENE_OUTLINE_H

#include <cstdint>
#include <string>
#include <vector>

#include "base/math.h"
#include "job/interactive/session.h"
#include "scene/model/scene.h"

namespace quintet::viewer {

struct InstanceOutline {
  std::string name;  // scene::instanceNames()
  std::string mesh;  // name; can be empty
  std::uint64_t triangles = 0;
  std::uint64_t boxes = 0;             // of procedural primitives
  std::vector<std::size_t> materials;  // indices, without duplicates; the default material is not listed
  bool animated = false;
  Bounds3 bounds;              // of the mesh, object space
  mat4 worldFromObject{1.0f};  // as it was loaded
};

struct SceneOutline {
  std::string name;
  std::vector<InstanceOutline> instances;
  std::vector<std::string> materialNames;
  std::vector<scene::Material> materials;  // as they were loaded
  std::vector<std::string> lightNames;
  std::vector<scene::Light> lights;     // as they were loaded
  std::vector<std::string> cameras;     // names; unnamed cameras are "Camera 0", "Camera 1", …
  std::vector<std::string> variants;    // names of the material variants of a glTF file
  std::vector<std::string> animations;  // names of the animations of a glTF file, or their indices
  scene::TriangleCount triangles;
  float lastFrame = 0;  // 0 without an animation
  float size = 1;       // meters: diagonal of the bounds, 1 if they are empty
};

SceneOutline outlineOf(const job::interactive::Session& session);

// Values with the edits of a state.
const scene::Material& materialOf(const SceneOutline& scene, const job::interactive::SessionState& state,
                                  std::size_t index);
job::interactive::LightState lightOf(const SceneOutline& scene, const job::interactive::SessionState& state,
                                     std::size_t index);
mat4 transformOf(const SceneOutline& scene, const job::interactive::SessionState& state, std::size_t index);

}  // namespace quintet::viewer
#endif
