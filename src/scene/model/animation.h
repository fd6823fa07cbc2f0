// SPDX-License-Identifier: Apache-2.0
// An animation as plain structs: a tree of nodes, the channels that move them, skins, and the vertices that skins and
// morph targets deform (glTF 2.0 sections 3.7.2.2, 3.7.3 and 3.11), and values that change, of a glTF file or of the
// keyframes of a scene file. animation/pose.h evaluates it.
#ifndef QUINTET_SCENE_MODEL_ANIMATION_H
#define QUINTET_SCENE_MODEL_ANIMATION_H

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "base/math.h"

namespace quintet::scene {

inline constexpr double kDefaultFramesPerSecond = 24.0;

enum class Interpolation { step, linear, cubicSpline };

// A value as a function of time. Before the first time and after the last one it is constant.
struct AnimationSampler {
  Interpolation interpolation = Interpolation::linear;
  std::vector<float> times;  // seconds, strictly ascending, at least one; cubicSpline: at least two
  // One value per time; cubicSpline: in-tangent, value and out-tangent per time.
  std::vector<float> values;
  std::size_t valueSize = 1;  // number of floats of one value: 3, 4, or the number of morph weights
};

// Of a node. The visibility is one number, 0 if the node is hidden.
enum class AnimatedProperty { translation, rotation, scale, weights, visibility };

struct AnimationChannel {
  int node = -1;  // index in NodeAnimation::nodes
  AnimatedProperty property = AnimatedProperty::translation;
  std::size_t sampler = 0;  // index in Animation::samplers; a rotation is a quaternion x, y, z, w
};

struct Animation {
  std::string name;
  std::vector<AnimationSampler> samplers;
  std::vector<AnimationChannel> channels;  // at most one per node and property
};

// A property of a material, light or camera that follows a sampler (KHR_animation_pointer, keyframes of a scene file).
struct AnimatedValue {
  std::size_t property = 0;  // index in the table of the kind of object (animation/properties.h)
  std::size_t value = 0;     // index in NodeAnimation::values
  bool operator==(const AnimatedValue&) const = default;
};

struct AnimatedMaterial {
  int material = -1;                  // index in Scene::materials
  std::vector<AnimatedValue> values;  // sorted by property
};

struct AnimationNode {
  int parent = -1;  // index in NodeAnimation::nodes; -1 for a root
  // Local transform without channels: translation · rotation · scale.
  glm::dvec3 translation{0.0};
  glm::dquat rotation{1, 0, 0, 0};  // w, x, y, z; unit
  glm::dvec3 scale{1.0};
  glm::dmat4 matrix{1.0};  // instead, if hasMatrix
  bool hasMatrix = false;
  std::vector<float> weights;  // of the morph targets of its mesh, without channels
  bool visible = true;         // without channels; a hidden node hides its descendants
};

struct Skin {
  std::vector<int> joints;                // indices in NodeAnimation::nodes
  std::vector<mat4> inverseBindMatrices;  // one per joint
};

// All nodes of a file, by their index in the file, and the animation that plays. A scene file has the nodes and the
// animations of all its glTF files, one after the other, and the samplers of its keyframes.
struct NodeAnimation {
  std::vector<AnimationNode> nodes;
  std::vector<int> order;  // of `nodes`, parents before children
  std::vector<Skin> skins;
  Animation animation;
  std::vector<std::size_t> values;                   // samplers (Animation::samplers) that AnimatedValue refers to
  std::vector<AnimatedMaterial> materials;           // that change; each at most once
  double framesPerSecond = kDefaultFramesPerSecond;  // > 0; time in seconds = frame / framesPerSecond
};

// Displacements of one target. Each vector is empty or has one element per vertex.
struct MorphTarget {
  std::vector<vec3> positions;
  std::vector<vec3> normals;
  std::vector<vec3> tangents;
};

// Four joints and weights per vertex. A mesh can have several sets.
struct SkinSet {
  std::vector<glm::u16vec4> joints;  // indices in Skin::joints
  std::vector<vec4> weights;         // the sum over all sets is normalized
};

// The vertices of a geometry before deformation, in object space. Arrays are empty or have one element per vertex.
struct GeometryDeformation {
  std::vector<vec3> positions;
  std::vector<vec3> normals;
  std::vector<vec4> tangents;
  bool faceNormals = false;  // the normals are those of the triangles, which have vertices of their own
  // Of a mesh with a skin, before joints mirror them (animation/deform.h). Else empty: the triangles do not change.
  std::vector<uvec3> triangles;
  std::vector<MorphTarget> targets;
  std::vector<SkinSet> skinSets;
};

// How an animation deforms a mesh. The mesh belongs to one node.
struct MeshDeformation {
  int node = -1;  // index in NodeAnimation::nodes, for its morph weights
  // Index in NodeAnimation::skins. With a skin the vertices are in world space: those of geometries without skin sets
  // follow the node. -1 means no skin; the vertices are then in object space.
  int skin = -1;
  std::vector<GeometryDeformation> geometries;  // parallel to Mesh::geometries
};

// Of an animation in a file, whether it plays or not.
struct AnimationSummary {
  std::string name;    // may be empty
  double seconds = 0;  // largest time
  std::size_t channels = 0;
  std::size_t ignored = 0;  // of the channels, those with an unsupported target
};

// Of an object of a scene file with keyframes.
struct KeyframeSummary {
  struct Key {
    std::string name;  // "position"
    Interpolation interpolation = Interpolation::linear;
  };
  std::string object;     // "[[light]] 'lamp'"
  std::vector<Key> keys;  // that change
  std::size_t count = 0;  // of keyframes, at least 1
  double firstSeconds = 0, lastSeconds = 0;
};

}  // namespace quintet::scene
#endif
