// SPDX-License-Identifier: Apache-2.0
// The scene as plain structs. Importers fill it; `render` uploads it to the GPU. Units are meters; the frame is
// right-handed with y up; radiometric values use linear Rec. 709 primaries. References are indices into the vectors of
// the scene (-1 means none); importers return only valid ones (validate.h).
#ifndef QUINTET_SCENE_MODEL_SCENE_H
#define QUINTET_SCENE_MODEL_SCENE_H

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "base/math.h"
#include "io/image.h"
#include "scene/model/animation.h"
#include "scene/model/procedural.h"
#include "scene/model/report.h"

namespace quintet::scene {

inline constexpr int kNone = -1;
inline constexpr int kMaxUvSets = 2;  // TEXCOORD_0 and TEXCOORD_1

enum class Wrap : std::uint32_t { repeat, mirroredRepeat, clampToEdge };
enum class Filter : std::uint32_t { linear, nearest };

struct Sampler {
  Wrap wrapU = Wrap::repeat;
  Wrap wrapV = Wrap::repeat;
  Filter filter = Filter::linear;  // glTF's magFilter; there are no mip levels
  bool operator==(const Sampler&) const = default;
};

struct Texture {
  std::string name;
  int image = kNone;  // index in Scene::images
  Sampler sampler;
};

// One use of a texture by a material. The texture coordinate is transformed as in KHR_texture_transform:
//   uv' = translation(offset) · rotation · scale · uv
struct TextureUse {
  int texture = kNone;  // index in Scene::textures
  int uvSet = 0;        // 0 … kMaxUvSets-1
  vec2 offset{0.0f};
  vec2 scale{1.0f};
  float rotation = 0.0f;  // radians; direction as in KHR_texture_transform
  bool used() const { return texture != kNone; }
  bool operator==(const TextureUse&) const = default;
};

enum class AlphaMode : std::uint32_t { opaque, mask, blend };

// The metallic-roughness material of glTF 2.0 with extensions. Factors multiply the value of the texture. Textures of
// base color, emission, specular color, sheen color and diffuse transmission color are sRGB-encoded, the others linear.
struct Material {
  std::string name;
  vec4 baseColor{1.0f};                 // linear, [0,1]; alpha is coverage
  TextureUse baseColorTexture;          // rgb: color, a: alpha
  float metallic = 1.0f;                // [0,1]
  float roughness = 1.0f;               // perceptual, [0,1]; alpha = roughness²
  TextureUse metallicRoughnessTexture;  // g: roughness, b: metallic
  TextureUse normalTexture;             // tangent space, y up (OpenGL convention)
  float normalScale = 1.0f;
  TextureUse occlusionTexture;  // not used by a path tracer
  float occlusionStrength = 1.0f;
  vec3 emissive{0.0f};  // radiance in W/(sr·m²), including the strength, ≥ 0
  TextureUse emissiveTexture;
  AlphaMode alphaMode = AlphaMode::opaque;
  float alphaCutoff = 0.5f;
  bool doubleSided = false;
  bool unlit = false;              // KHR_materials_unlit: the base color is the outgoing radiance
  float ior = 1.5f;                // KHR_materials_ior, ≥ 1, or 0 for a Fresnel term of 1
  float transmission = 0.0f;       // KHR_materials_transmission, [0,1]
  TextureUse transmissionTexture;  // r
  float thickness = 0.0f;          // KHR_materials_volume; 0 means thin-walled, above 0 a closed solid
  float attenuationDistance = std::numeric_limits<float>::infinity();  // meters, > 0
  vec3 attenuationColor{1.0f};      // color of white light after attenuationDistance, (0,1]
  float specular = 1.0f;            // KHR_materials_specular, [0,1]
  TextureUse specularTexture;       // a
  vec3 specularColor{1.0f};         // ≥ 0, tint of F0
  TextureUse specularColorTexture;  // rgb, sRGB
  float clearcoat = 0.0f;           // KHR_materials_clearcoat, [0,1]
  TextureUse clearcoatTexture;      // r
  float clearcoatRoughness = 0.0f;
  TextureUse clearcoatRoughnessTexture;  // g
  TextureUse clearcoatNormalTexture;
  float clearcoatNormalScale = 1.0f;
  vec3 sheenColor{0.0f};                       // KHR_materials_sheen, [0,1]; black means no sheen
  TextureUse sheenColorTexture;                // rgb, sRGB
  float sheenRoughness = 0.0f;                 // perceptual, [0,1]; alpha = sheenRoughness²
  TextureUse sheenRoughnessTexture;            // a
  float diffuseTransmission = 0.0f;            // KHR_materials_diffuse_transmission, [0,1]
  TextureUse diffuseTransmissionTexture;       // a
  vec3 diffuseTransmissionColor{1.0f};         // [0,1]
  TextureUse diffuseTransmissionColorTexture;  // rgb, sRGB
  float anisotropy = 0.0f;                     // KHR_materials_anisotropy, strength, [0,1]
  float anisotropyRotation = 0.0f;             // radians, from the tangent to the bitangent
  TextureUse anisotropyTexture;                // rg: direction in tangent space, [-1,1]; b: strength
  float iridescence = 0.0f;                    // KHR_materials_iridescence, weight of the thin film, [0,1]
  TextureUse iridescenceTexture;               // r
  float iridescenceIor = 1.3f;                 // of the film, ≥ 1
  float iridescenceThicknessMinimum = 100.0f;  // nanometers, ≥ 0; where the texture is 0
  float iridescenceThicknessMaximum = 400.0f;  // nanometers, ≥ 0; where the texture is 1, and without a texture
  TextureUse iridescenceThicknessTexture;      // g
  float dispersion = 0.0f;                     // KHR_materials_dispersion, 20 / Abbe number, ≥ 0; for solids
  vec3 multiscatterColor{0.0f};                // KHR_materials_volume_scatter, color after many scatterings, [0,1]
  float scatterAnisotropy = 0.0f;              // (-1,1), of the phase function; above 0 scatters forwards
  float dielectricPriority = 0.0f;             // where solids overlap, the highest one fills the space
  bool operator==(const Material&) const = default;
};

// A list of triangles. Every attribute is empty or has positions.size() elements.
struct Geometry {
  std::vector<vec3> positions;   // object space
  std::vector<uvec3> triangles;  // vertex indices, counter-clockwise seen from the front
  std::vector<vec3> normals;     // unit; empty means flat shading by the face normal
  std::vector<vec4> tangents;    // xyz unit, w = ±1: bitangent = w · cross(normal, tangent)
  std::array<std::vector<vec2>, kMaxUvSets> uvs;
  std::vector<vec4> colors;  // linear RGBA, multiplies the base color
  int material = kNone;      // index in Scene::materials; kNone means the default material
  // Index in the file of each triangle, if triangles with non-finite vertices were dropped. Empty means the same index.
  std::vector<std::uint32_t> fileTriangles;
  // Index in the file of each vertex, while a geometry that an animation deforms is imported. Empty otherwise.
  std::vector<std::uint32_t> fileVertices;
};

// One BLAS: the geometries of one glTF mesh, or sets of procedural primitives. Not both, because Vulkan does not mix
// triangles and boxes in a BLAS.
struct Mesh {
  std::string name;
  std::vector<Geometry> geometries;
  std::vector<PrimitiveSet> primitiveSets;
  // Of a mesh that the animation of the scene deforms; `geometries` is then its shape at frame 0. Else null.
  std::shared_ptr<const MeshDeformation> deformation;
  bool procedural() const { return !primitiveSets.empty(); }
  // Number of hit records per ray type.
  std::size_t geometryCount() const { return procedural() ? primitiveSets.size() : geometries.size(); }
};

// Bits of Instance::flags, as in VkGeometryInstanceFlagBitsKHR.
inline constexpr std::uint32_t kInstanceCullDisable = 1;
inline constexpr std::uint32_t kInstanceFlipFacing = 2;
inline constexpr std::uint32_t kInstanceForceOpaque = 4;
inline constexpr std::uint32_t kInstanceForceNoOpaque = 8;

// Transform of an instance at a frame of an animation.
struct Keyframe {
  float frame = 0;
  vec3 translation{0.0f};
  quat rotation{1, 0, 0, 0};  // w, x, y, z; unit
  vec3 scale{1.0f};
};

// How the parts of keyframes are interpolated (animation/keyframes.h).
struct KeyframeInterpolation {
  Interpolation translation = Interpolation::linear;
  Interpolation rotation = Interpolation::linear;
  Interpolation scale = Interpolation::linear;
  bool operator==(const KeyframeInterpolation&) const = default;
};

struct Instance {
  std::string name;  // of the node
  int mesh = kNone;
  mat4 worldFromObject{1.0f};       // affine; can mirror (negative determinant)
  std::uint32_t mask = 0xFF;        // 8 bits, ANDed with the ray's cull mask
  std::uint32_t flags = 0;          // kInstance… bits
  std::uint32_t customIndex = 0;    // 24 bits, for the program
  std::vector<Keyframe> keyframes;  // ascending frames; if not empty, worldFromObject is the transform at frame 0
  KeyframeInterpolation interpolation;
  // Index in NodeAnimation::nodes of the node that the instance follows, or kNone. worldFromObject is then the
  // transform at frame 0.
  int node = kNone;
  int visibleNode = kNone;        // in NodeAnimation::nodes: the instance is visible whenever this node is
  mat4 animatedFromObject{1.0f};  // applied before the keyframe or the node's transform (animation/pose.h)
  mat4 placedFromRoot{1.0f};      // applied after the node's transform, before the keyframe
  bool animated() const { return node != kNone || visibleNode != kNone || !keyframes.empty(); }
};

struct Camera {
  std::string name;
  std::string nodeName;  // of the glTF node that has the camera; empty if it has none
  bool orthographic = false;
  float verticalFov = glm::radians(45.0f);  // radians, perspective only
  float aspect = 0.0f;                      // width / height stated by the file; 0 means that of the image
  vec2 orthographicHalfSize{1.0f};          // meters: glTF's xmag, ymag
  mat4 worldFromCamera{1.0f};               // rigid; the camera looks along -z, y up
  float apertureRadius = 0.0f;              // meters; 0 means a pinhole
  float focusDistance = 1.0f;               // meters along the optical axis, > 0
  int node = kNone;           // in NodeAnimation::nodes: the camera follows it, and worldFromCamera is that of frame 0
  mat4 placedFromRoot{1.0f};  // applied after the node's transform
  std::vector<AnimatedValue> values;  // sorted by property; the camera is that of frame 0
  bool animated() const { return node != kNone || !values.empty(); }
};

enum class LightType : std::uint32_t { point, spot, directional };

// KHR_lights_punctual.
struct Light {
  std::string name;
  LightType type = LightType::point;
  vec3 intensity{1.0f};               // with the color; point, spot: W/sr (glTF candela); directional: W/m² (glTF lux)
  vec3 position{0.0f};                // world space
  vec3 direction{0, 0, -1};           // world space, unit, in which the light travels
  float innerConeAngle = 0.0f;        // radians from the axis, 0 to outerConeAngle; of spot lights
  float outerConeAngle = kPi / 4.0f;  // radians, at most π/2
  float range = std::numeric_limits<float>::infinity();  // meters, > 0; point, spot: no light arrives beyond it
  int node = kNone;  // in NodeAnimation::nodes: the light follows it; position and direction are those of frame 0
  int visibleNode = kNone;            // in NodeAnimation::nodes: the light shines whenever this node is visible
  mat4 placedFromRoot{1.0f};          // applied after the node's transform
  std::vector<AnimatedValue> values;  // sorted by property; the light is that of frame 0
  bool animated() const { return node != kNone || visibleNode != kNone || !values.empty(); }
  bool operator==(const Light&) const = default;
};

// Equirectangular radiance. Texture coordinates of direction d: u = atan2(d.z, d.x)/2π + 0.5, v = acos(d.y)/π from the
// top row (the convention of the reference images). An empty image means `constant` everywhere.
struct Environment {
  std::string name;
  io::Image image;                    // float RGB(A), linear, or empty
  vec3 constant{0.0f};                // radiance
  float intensity = 1.0f;             // multiplies image and constant
  float rotation = 0.0f;              // radians about +y, counter-clockwise seen from above
  bool present = false;               // false if the file has no environment; the renderer then chooses one
  std::vector<AnimatedValue> values;  // sorted by property; the environment is that of frame 0
  // Change what the animation sets, for users who adjust the environment.
  float animatedIntensityFactor = 1.0f;
  float animatedRotationOffset = 0.0f;  // radians
};

struct NamedImage {
  std::string name;  // path, or "scene.glb: /images/3"
  io::Image image;
};

// Wall-clock time of the steps of an importer, in seconds; 0 if the importer does not measure it.
struct ImportSeconds {
  double document = 0;  // reads the file, parses and checks its JSON
  double meshes = 0;    // reads attributes, repairs, generates tangents
  double images = 0;    // decodes the images
};

struct Scene {
  std::string name;  // file name
  std::vector<Mesh> meshes;
  std::vector<Instance> instances;
  std::vector<Material> materials;
  std::vector<Texture> textures;
  std::vector<NamedImage> images;
  std::vector<Camera> cameras;
  std::vector<Light> lights;
  Environment environment;
  // Moves instances, cameras and lights with a node, deforms meshes, and changes values. Null if no glTF animation plays
  // and only instances have keyframes. The scene is that of frame 0.
  std::shared_ptr<const NodeAnimation> nodeAnimation;
  // Of each material, some of its states during the animation: each feature that it has at any time, one of them has.
  // Empty without animated materials; else parallel to `materials`, and empty for those that do not change.
  std::vector<std::vector<Material>> materialStates;
  Report report;
  ImportSeconds seconds;
};

// Whether the scene changes with the frame: keyframes, or a glTF animation that plays.
bool isAnimated(const Scene&);

// World-space bounds of all instances; empty without instances.
Bounds3 worldBounds(const Scene&);
struct TriangleCount {
  std::uint64_t stored = 0;     // each mesh counted once
  std::uint64_t instanced = 0;  // each mesh counted once per instance
};
TriangleCount countTriangles(const Scene&);

// Primitive sets and their contents, each mesh counted once.
struct ProceduralCount {
  std::uint64_t sets = 0;
  std::uint64_t solids = 0;  // not in trees
  std::uint64_t csgTrees = 0;
  std::uint64_t csgLeaves = 0;
  std::uint64_t customBoxes = 0;
};
ProceduralCount countProcedural(const Scene&);

}  // namespace quintet::scene
#endif
