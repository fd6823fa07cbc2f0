// The scene as plain data: what an importer fills and what `render` turns into GPU buffers.
// Units: metres; right-handed, y up; radiometry in linear Rec. 709 primaries. All cross references are
// indices into the scene's own vectors (-1: none); an importer hands over only valid ones (validate.h).
#ifndef QUINTET_SCENE_SCENE_H
#define QUINTET_SCENE_SCENE_H

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/math.h"
#include "io/image.h"
#include "scene/procedural.h"

namespace quintet::scene {

inline constexpr int kNone = -1;
inline constexpr int kMaxUvSets = 2;  // a material may choose among TEXCOORD_0 … TEXCOORD_1

enum class Wrap : std::uint32_t { repeat, mirroredRepeat, clampToEdge };
enum class Filter : std::uint32_t { linear, nearest };

struct Sampler {
  Wrap wrapU = Wrap::repeat;
  Wrap wrapV = Wrap::repeat;
  Filter filter = Filter::linear;  // from glTF's magFilter; we have no mip levels
  bool operator==(const Sampler&) const = default;
};

struct Texture {
  std::string name;
  int image = kNone;  // Scene::images
  Sampler sampler;
};

// One use of a texture by a material. The texture coordinate is
//   uv' = translation(offset) · rotation · scale · uv   (KHR_texture_transform's matrix).
struct TextureUse {
  int texture = kNone;  // Scene::textures
  int uvSet = 0;        // 0 … kMaxUvSets-1
  vec2 offset{0.0f};
  vec2 scale{1.0f};
  float rotation = 0.0f;  // radians, as KHR_texture_transform defines its sense
  bool used() const { return texture != kNone; }
};

enum class AlphaMode : std::uint32_t { opaque, mask, blend };

// glTF 2.0 metallic-roughness with extensions. Factors multiply the texture's value.
// Colour textures (base colour, emissive, specular colour) are sRGB-encoded, all others linear data.
struct Material {
  std::string name;
  vec4 baseColor{1.0f};                 // linear, [0,1]; alpha is coverage
  TextureUse baseColorTexture;          // rgb · colour, a · alpha
  float metallic = 1.0f;                // [0,1]
  float roughness = 1.0f;               // perceptual, [0,1]; alpha = roughness²
  TextureUse metallicRoughnessTexture;  // g: roughness, b: metallic
  TextureUse normalTexture;             // tangent space, y up (OpenGL convention)
  float normalScale = 1.0f;
  TextureUse occlusionTexture;  // kept for the record: a path tracer does not use it
  float occlusionStrength = 1.0f;
  vec3 emissive{0.0f};  // radiance in W/(sr·m²) units of the scene, strength included, ≥ 0
  TextureUse emissiveTexture;
  AlphaMode alphaMode = AlphaMode::opaque;
  float alphaCutoff = 0.5f;
  bool doubleSided = false;
  bool unlit = false;              // KHR_materials_unlit: base colour is the outgoing radiance
  float ior = 1.5f;                // KHR_materials_ior, ≥ 1 (0 in the file: Fresnel term 1, kept as 0)
  float transmission = 0.0f;       // KHR_materials_transmission, [0,1]
  TextureUse transmissionTexture;  // r
  float thickness = 0.0f;          // KHR_materials_volume; 0: thin-walled, else a closed solid
  float attenuationDistance = std::numeric_limits<float>::infinity();  // metres, > 0
  vec3 attenuationColor{1.0f};      // colour of white light after attenuationDistance, (0,1]
  float specular = 1.0f;            // KHR_materials_specular, [0,1]
  TextureUse specularTexture;       // a
  vec3 specularColor{1.0f};         // ≥ 0, F0 tint
  TextureUse specularColorTexture;  // rgb, sRGB
  float clearcoat = 0.0f;           // KHR_materials_clearcoat, [0,1]
  TextureUse clearcoatTexture;      // r
  float clearcoatRoughness = 0.0f;
  TextureUse clearcoatRoughnessTexture;  // g
  TextureUse clearcoatNormalTexture;
  float clearcoatNormalScale = 1.0f;
};

// A triangle list. Every attribute is empty or has positions.size() elements.
struct Geometry {
  std::vector<vec3> positions;   // object space
  std::vector<uvec3> triangles;  // vertex indices, counter-clockwise seen from the front
  std::vector<vec3> normals;     // unit; empty: flat shading by the face normal
  std::vector<vec4> tangents;    // xyz unit, w = ±1: bitangent = w · cross(normal, tangent)
  std::array<std::vector<vec2>, kMaxUvSets> uvs;
  std::vector<vec4> colors;  // linear RGBA, multiplies the base colour
  int material = kNone;      // Scene::materials; kNone: the default material
  // Position of each triangle in the file's own numbering when some were dropped (degenerate NaN
  // vertices, broken indices); empty: identity.
  std::vector<std::uint32_t> fileTriangles;
};

// One BLAS: the geometries of one glTF mesh, or sets of procedural primitives. Not both: Vulkan does not
// mix triangles and boxes in a BLAS.
struct Mesh {
  std::string name;
  std::vector<Geometry> geometries;
  std::vector<PrimitiveSet> primitiveSets;
  bool procedural() const { return !primitiveSets.empty(); }
  // Hit records per ray type.
  std::size_t geometryCount() const { return procedural() ? primitiveSets.size() : geometries.size(); }
};

// Bits of Instance::flags, as in VkGeometryInstanceFlagBitsKHR.
inline constexpr std::uint32_t kInstanceCullDisable = 1;
inline constexpr std::uint32_t kInstanceFlipFacing = 2;
inline constexpr std::uint32_t kInstanceForceOpaque = 4;
inline constexpr std::uint32_t kInstanceForceNoOpaque = 8;

// Where an instance is at a frame of an animation; between keyframes translation and scale are
// interpolated linearly, rotation spherically.
struct Keyframe {
  float frame = 0;
  vec3 translation{0.0f};
  quat rotation{1, 0, 0, 0};  // w, x, y, z; unit
  vec3 scale{1.0f};
};

struct Instance {
  std::string name;  // the node's
  int mesh = kNone;
  mat4 worldFromObject{1.0f};       // affine; may mirror (negative determinant)
  std::uint32_t mask = 0xFF;        // 8 bits, against the ray's cull mask
  std::uint32_t flags = 0;          // kInstance…
  std::uint32_t customIndex = 0;    // 24 bits, the user's own
  std::vector<Keyframe> keyframes;  // ascending frames; empty: worldFromObject always. Else that is frame 0
  mat4 keyframeFromObject{1.0f};    // with keyframes: where the object is in the frame that they move (keyframes.h)
};

struct Camera {
  std::string name;
  bool orthographic = false;
  float verticalFov = glm::radians(45.0f);  // radians, perspective only
  float aspect = 0.0f;                      // width/height stated by the file; 0: as the image
  vec2 orthographicHalfSize{1.0f};          // metres: glTF's xmag, ymag
  mat4 worldFromCamera{1.0f};               // rigid; camera looks along -z, y up
  float apertureRadius = 0.0f;              // metres; 0: pinhole
  float focusDistance = 1.0f;               // metres along the optical axis, > 0
};

enum class LightType : std::uint32_t { point, spot, directional };

// KHR_lights_punctual.
struct Light {
  std::string name;
  LightType type = LightType::point;
  vec3 intensity{1.0f};         // point, spot: W/sr (glTF candela); directional: W/m² (glTF lux); colour included
  vec3 position{0.0f};          // world
  vec3 direction{0, 0, -1};     // world, unit, the way the light travels
  float innerConeAngle = 0.0f;  // radians, from the axis
  float outerConeAngle = kPi / 4.0f;                     // radians
  float range = std::numeric_limits<float>::infinity();  // metres; kept for the record, physically ignored
};

// Equirectangular radiance. Direction d ↔ texel: u = atan2(d.z, d.x)/2π + 0.5, v = acos(d.y)/π from the
// top row (the convention of the reference pictures). An empty image means `constant` everywhere.
struct Environment {
  std::string name;
  io::Image image;         // float RGB(A), linear, or empty
  vec3 constant{0.0f};     // radiance
  float intensity = 1.0f;  // multiplies both
  float rotation = 0.0f;   // radians about +y, counter-clockwise seen from above
  bool present = false;    // false: the file has none; the renderer decides
};

struct NamedImage {
  std::string name;  // file or "scene.glb: /images/3"
  io::Image image;
};

// What an importer used, ignored and repaired; shown by `quintet info`.
struct Report {
  std::vector<std::string> extensionsUsed;     // of the file, that Quintet understands
  std::vector<std::string> extensionsIgnored;  // of the file, that it does not
  std::vector<std::string> ignored;            // "/meshes/0/primitives/2: mode LINES has no surface"
  std::vector<std::string> repaired;           // "/meshes/0/primitives/0: 3 triangles with non-finite vertices dropped"
  std::string generator;                       // asset.generator
  std::string copyright;                       // asset.copyright
  std::vector<std::filesystem::path> files;    // that were read: the scene file, glTF files, their buffers and images
};

// Wall clock of an importer's steps, seconds; 0: the importer does not count it.
struct ImportSeconds {
  double document = 0;  // the file read, its JSON parsed and checked
  double meshes = 0;    // attributes, repairs, tangents
  double images = 0;    // decoded
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
  Report report;
  ImportSeconds seconds;
};

// World-space box of all instances; empty if there is none.
Bounds3 worldBounds(const Scene&);
// Triangles over all instances (instanced count) and stored once.
struct TriangleCount {
  std::uint64_t stored = 0;
  std::uint64_t instanced = 0;
};
TriangleCount countTriangles(const Scene&);
// Primitive sets and what they hold, stored once.
struct ProceduralCount {
  std::uint64_t sets = 0;
  std::uint64_t solids = 0;  // outside of trees
  std::uint64_t csgTrees = 0;
  std::uint64_t csgLeaves = 0;
  std::uint64_t customBoxes = 0;
};
ProceduralCount countProcedural(const Scene&);

}  // namespace quintet::scene
#endif
