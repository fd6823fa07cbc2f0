// SPDX-License-Identifier: Apache-2.0
// A scene at a frame of its animation. This is the reference of what the device shows: `render` computes the same
// transforms and vertices with these functions.
#ifndef QUINTET_SCENE_ANIMATION_POSE_H
#define QUINTET_SCENE_ANIMATION_POSE_H

#include <span>
#include <vector>

#include "scene/model/scene.h"

namespace quintet::scene {

struct Pose {
  double frame = 0;
  std::vector<mat4> worldFromNode;          // per node; empty without NodeAnimation
  std::vector<std::vector<float>> weights;  // of morph targets, per node; empty without NodeAnimation
  std::vector<bool> visible;                // per node; empty without NodeAnimation
  std::vector<vec4> values;                 // of NodeAnimation::values, padded with 0
};

// `animation` can be null. The time is frame / framesPerSecond; before the first time of a channel and after its last
// one, its value is constant.
Pose poseAt(const NodeAnimation* animation, double frame);

// Interpolated keyframe · transform of the node · animatedFromObject, as far as the instance has them; else
// worldFromObject. Visible or not.
mat4 worldFromObjectAt(const Instance&, const Pose&);
// The same for what rays hit: an instance that is not visible has a singular transform, which keeps the position.
mat4 shownTransformAt(const Instance&, const Pose&);
// The camera or light at its node, with its animated properties; unchanged without them. The frame of a camera stays
// rigid. A light that is not visible has the intensity 0.
Camera cameraAt(const Camera&, const Pose&);
Light lightAt(const Light&, const Pose&);
void moveEnvironment(Environment&, const Pose&);  // in place, because it can have a large image
Material materialAt(const Material&, std::span<const AnimatedValue>, const Pose&);

// Last frame at which something changes, of keyframes and of the glTF animation; 0 without animation.
float lastFrame(const Scene&);

// Matrices of the joints: world transform of the joint · inverse bind matrix.
std::vector<mat4> jointMatrices(const Skin&, const Pose&);

// Writes positions, normals, tangents and, with a skin, triangles of geometry `index` of the deformed mesh; the other arrays of
// `out` are those of the mesh. The number of vertices does not depend on the pose. Normals and tangents are unit. A position that
// is not finite is that of the undeformed vertex.
void deformGeometry(const MeshDeformation&, std::size_t index, const NodeAnimation&, const Pose&, Geometry& out);

// Moves instances, cameras and lights, changes materials, and deforms meshes. Keyframes stay, and so do the
// deformations. With Hidden::hide, instances and lights that are not visible disappear (shownTransformAt, lightAt), and
// another pose does not show them again.
enum class Hidden { keep, hide };
void applyPose(Scene&, const Pose&, Hidden = Hidden::hide);

}  // namespace quintet::scene
#endif
