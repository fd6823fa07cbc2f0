// SPDX-License-Identifier: Apache-2.0
// Scenes: from files, or built from meshes, materials, textures, instances, lights and cameras in memory.
//
// Units are meters; the frame is right-handed with y up. Radiometric values use linear Rec. 709 primaries. Objects are
// referred to by the index that the function that added them returned.
#ifndef QUINTET_SCENE_H
#define QUINTET_SCENE_H

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <quintet/cancellation.h>
#include <quintet/diagnostic.h>
#include <quintet/error.h>
#include <quintet/types.h>

namespace quintet {

class Program;

// What a texture coordinate outside [0,1] shows.
enum class Wrap { repeat, mirroredRepeat, clampToEdge };
// How texels are interpolated; there are no mip levels.
enum class Filter { linear, nearest };

// Pixels of an image in memory: rows from the top, interleaved, width · height · channels values. Integers are unsigned
// normalized.
using PixelSpan = std::variant<std::span<const std::uint8_t>, std::span<const std::uint16_t>, std::span<const float>>;

// An image in memory with its sampler.
struct Texture {
  std::string name{};
  std::uint32_t width = 0;     // pixels
  std::uint32_t height = 0;    // pixels
  std::uint32_t channels = 4;  // 1 gray, 2 gray and alpha, 3 RGB, 4 RGBA with straight alpha
  PixelSpan pixels{};          // copied by addTexture. Integer colors are sRGB-encoded; floats are linear
  Wrap wrapU = Wrap::repeat;
  Wrap wrapV = Wrap::repeat;
  Filter filter = Filter::linear;
};

// One use of a texture by a material. Texture coordinates are transformed as in KHR_texture_transform.
struct TextureUse {
  int texture = -1;  // index of addTexture(); -1 means none
  int uvSet = 0;     // 0 or 1: Triangles::uv0 or uv1
  Float2 offset{0, 0};
  Float2 scale{1, 1};
  float rotation = 0;  // radians
  bool operator==(const TextureUse&) const = default;
};

// What the alpha of the base color means: nothing; a cutout at Material::alphaCutoff; coverage.
enum class AlphaMode { opaque, mask, blend };

// The metallic-roughness material of glTF 2.0 with its extensions. Factors multiply the value of the texture. Textures of
// base color, emission, specular color, sheen color and diffuse transmission color are sRGB-encoded unless they are floats;
// all others are linear.
struct Material {
  std::string name{};
  Float4 baseColor{1, 1, 1, 1};           // linear, [0,1]; alpha is coverage
  TextureUse baseColorTexture{};          // rgb: color, a: alpha
  float metallic = 0;                     // [0,1]; unlike glTF, the default is a dielectric
  float roughness = 1;                    // perceptual, [0,1]
  TextureUse metallicRoughnessTexture{};  // g: roughness, b: metallic
  TextureUse normalTexture{};             // tangent space, y up
  float normalScale = 1;
  Float3 emissive{0, 0, 0};  // radiance in W/(sr·m²), >= 0
  TextureUse emissiveTexture{};
  AlphaMode alphaMode = AlphaMode::opaque;
  float alphaCutoff = 0.5f;
  bool doubleSided = false;
  bool unlit = false;                // the base color is the outgoing radiance
  float ior = 1.5f;                  // index of refraction, >= 1
  float transmission = 0;            // [0,1]
  TextureUse transmissionTexture{};  // r
  float thickness = 0;               // meters; 0 means thin-walled, above 0 a closed solid
  float attenuationDistance = std::numeric_limits<float>::infinity();  // meters, > 0
  Float3 attenuationColor{1, 1, 1};        // color of white light after attenuationDistance, (0,1]
  float specular = 1;                      // [0,1]
  TextureUse specularTexture{};            // a
  Float3 specularColor{1, 1, 1};           // >= 0, tint of the reflectance at normal incidence
  TextureUse specularColorTexture{};       // rgb
  float clearcoat = 0;                     // [0,1]
  TextureUse clearcoatTexture{};           // r
  float clearcoatRoughness = 0;            // [0,1]
  TextureUse clearcoatRoughnessTexture{};  // g
  TextureUse clearcoatNormalTexture{};
  float clearcoatNormalScale = 1;
  Float3 sheenColor{0, 0, 0};                    // [0,1]; black means no sheen
  TextureUse sheenColorTexture{};                // rgb
  float sheenRoughness = 0;                      // [0,1]
  TextureUse sheenRoughnessTexture{};            // a
  float diffuseTransmission = 0;                 // [0,1], part of the diffuse light that passes to the other side
  TextureUse diffuseTransmissionTexture{};       // a
  Float3 diffuseTransmissionColor{1, 1, 1};      // [0,1]
  TextureUse diffuseTransmissionColorTexture{};  // rgb
  float anisotropy = 0;                          // [0,1], strength; roughness grows along one direction
  float anisotropyRotation = 0;                  // radians, of this direction, from the tangent to the bitangent
  TextureUse anisotropyTexture{};                // rg: direction in tangent space, b: strength
  float iridescence = 0;                         // [0,1], weight of a thin film over the surface
  TextureUse iridescenceTexture{};               // r
  float iridescenceIor = 1.3f;                   // index of refraction of the film, >= 1
  float iridescenceThicknessMinimum = 100;       // nanometers, >= 0; where the texture is 0
  float iridescenceThicknessMaximum = 400;       // nanometers, >= 0; where the texture is 1, and without a texture
  TextureUse iridescenceThicknessTexture{};      // g
  float dispersion = 0;                          // 20 / Abbe number, >= 0; colors refract differently in solids
  Float3 multiscatterColor{0, 0, 0};             // [0,1], color of a solid that scatters; black means it only absorbs
  float scatterAnisotropy = 0;                   // (-1,1); above 0, solids scatter forwards
  float dielectricPriority = 0;                  // where solids overlap, the highest one fills the space
  bool operator==(const Material&) const = default;
};

// Triangles with one material. The spans are read by addMesh() and can be freed afterwards. Every attribute has
// positions.size() elements or is empty.
struct Triangles {
  std::span<const Float3> positions{};  // object space
  std::span<const UInt3>
      indices{};  // counter-clockwise seen from the front; empty: every three vertices are a triangle
  std::span<const Float3> normals{};     // unit; empty means flat shading
  std::span<const Float4> tangents{};    // xyz unit, w = ±1; bitangent = w · cross(normal, tangent); empty: computed
  std::span<const Float2> uv0{}, uv1{};  // texture coordinates; v points down
  std::span<const Float4> colors{};      // linear RGBA, multiplies the base color
  int material = -1;                     // index of addMaterial(); -1 means the default material
};

// Transform of an instance at a frame. Translation and scale are interpolated linearly, rotation spherically.
struct Keyframe {
  float frame = 0;
  Float3 translation{0, 0, 0};
  Float4 rotation{0, 0, 0, 1};  // unit quaternion x, y, z, w
  Float3 scale{1, 1, 1};
};

// A mesh with its position in the scene.
struct Instance {
  int mesh = -1;                // index of addMesh() or addBoxes()
  Transform worldFromObject{};  // invertible; can mirror
  std::string name{};
  std::uint32_t mask = 0xFF;          // 8 bits, ANDed with the cull mask of a ray
  std::uint32_t customIndex = 0;      // 24 bits, for the program
  std::vector<Keyframe> keyframes{};  // ascending frames; if not empty, they replace worldFromObject
};

// Lights without area (KHR_lights_punctual). Surfaces with Material::emissive are lights, too.
enum class LightType { point, spot, directional };

// A light without area.
struct Light {
  LightType type = LightType::point;
  Float3 intensity{1, 1, 1};   // with the color; point and spot: W/sr, directional: W/m²
  Float3 position{0, 0, 0};    // world space; not used by directional lights
  Float3 direction{0, -1, 0};  // world space, in which the light travels, any length but 0; not used by point lights
  float innerConeAngle = 0;    // radians from the axis, spot only
  float outerConeAngle = 0.785398163f;  // radians from the axis, (innerConeAngle, pi/2], spot only
  std::string name{};
  float range = std::numeric_limits<float>::infinity();  // meters, > 0; no light arrives beyond it; point and spot only
};

// A perspective camera with a thin lens.
struct Camera {
  Float3 lookFrom{0, 0, 5};     // world space
  Float3 lookAt{0, 0, 0};       // world space; also the point in focus
  Float3 up{0, 1, 0};           // world space, any length but 0
  float verticalFov = 0.7854f;  // radians, (0, pi)
  float apertureRadius = 0;     // meters; 0 is a pinhole camera
  bool operator==(const Camera&) const = default;
};

// Light from all directions, as an equirectangular image or a constant. u = 0.5 is +x, v = 0 is +y (up).
struct Environment {
  Float3 radiance{0, 0, 0};  // constant, W/(sr·m²), >= 0; used if `pixels` is empty
  std::uint32_t width = 0;   // pixels
  std::uint32_t height = 0;
  std::span<const Float3> pixels{};  // linear radiance, rows from the top; copied by setEnvironment
  float intensity = 1;               // factor
  float rotation = 0;                // radians about +y, counter-clockwise seen from above
};

// How a scene file is read.
struct LoadOptions {
  std::string scene{};    // index or name of a scene of the glTF file; empty means its default scene
  std::string variant{};  // name of a material variant of the glTF file; empty means the default materials
  // Name or index of the animation of the glTF file that Renderer::setFrame plays; empty means the first one, if the file
  // has one; "none" means the rest pose.
  std::string animation = "none";
  double framesPerSecond = 24.0;  // > 0; frame k of the animation is at k / framesPerSecond seconds
  bool strict = false;            // throw FileError with a list if a part of the file is ignored or repaired
  bool omitTextures = false;  // use the factors of materials if an image is missing or invalid, instead of FileError
  // Bytes of host memory that the file, and the files that it names, can request while they are read; 0 means 80 % of the
  // machine's memory. More is a MemoryError (Remedy::raiseMemoryLimit) before the memory is allocated.
  std::size_t maxMemory = 0;
  // Asked several times per second by the thread that loads; true ends it with CanceledError. May be empty.
  std::function<bool()> canceled{};
  bool allowExternal = false;  // read buffers and images of glTF files from outside of their folders
};

// How a scene uses a part of its file.
enum class FeatureUse {
  used,
  unused,    // cannot change the image
  repaired,  // used with a change
  ignored,   // can change the image, but is not supported or not valid
};

// A kind of content of a scene file, such as all attributes TEXCOORD_0 that are used.
struct Feature {
  std::string kind{};  // "extension", "attribute", "texture", …
  std::string name{};  // "KHR_materials_ior", "TEXCOORD_0", the name of a camera; empty for objects without a name
  FeatureUse use = FeatureUse::used;
  std::size_t count = 0;   // number of occurrences
  std::string location{};  // JSON pointer of the first one
  std::string reason{};    // why it is unused or ignored, how it is repaired or converted; else empty
};

// A property of the metadata of a file (KHR_xmp_json_ld).
struct MetadataEntry {
  std::string object{};  // JSON pointers of the objects that have it; "/asset" means the whole file
  std::string name{};    // "dc:title"
  std::string value{};
};

// What a scene file contains, and what the scene uses of it.
struct SceneReport {
  std::vector<Feature> features{};
  std::vector<std::string> ignored{};   // lines "LOCATION: REASON"
  std::vector<std::string> repaired{};  // lines "LOCATION: REPAIR"
  std::vector<MetadataEntry> metadata{};
};

// A scene in host memory: a value. Copies share their data until one of them changes. Functions that add or replace objects
// throw UsageError with the name of the object for indices out of range, attributes of the wrong length, values that are not
// finite, texels, emission and intensities above 1e12, and transforms that are not invertible; the scene is then unchanged. Only normals, tangents, texture coordinates and
// colors of vertices, and texels of files, are repaired instead. Use an object from one thread at a time; copies can be used
// from different threads.
class Scene {
 public:
  Scene();  // empty
  // Reads glTF (.gltf, .glb) or .scene.toml. Throws FileError, MemoryError, UsageError if the scene, the variant or the
  // animation does not exist.
  static Scene load(const std::filesystem::path& file, const LoadOptions& options = {});
  // Reads a scene in the format of .scene.toml. `folder` is where it looks for files that the text names. Throws FileError
  // with the line, MemoryError.
  static Scene fromToml(std::string_view text, const std::filesystem::path& folder = ".", std::size_t maxMemory = 0);
  // Returns the program's own scene, else a small built-in one with geometry that its hit groups support.
  static Scene of(const Program& program);

  // Each function returns the index of the new object.
  int addTexture(const Texture& texture);
  // PNG, JPEG, WebP, KTX2, HDR or OpenEXR. `maxMemory`: LoadOptions. Throws FileError, MemoryError.
  int addTexture(const std::filesystem::path& file, std::size_t maxMemory = 0);
  int addMaterial(const Material& material);                                         // its textures exist already
  int addMesh(const Triangles& triangles, const std::string& name = {});             // its material exists already
  int addMesh(std::span<const Triangles> geometries, const std::string& name = {});  // one mesh with several materials
  // Boxes in object space for the intersection shader of a program. Hit groups are bound to them by `name`.
  int addBoxes(std::span<const Bounds> boxes, int material = -1, const std::string& name = {});
  int addInstance(const Instance& instance);  // its mesh exists already
  int addLight(const Light& light);           // punctual; emissive surfaces are lights without this
  int addCamera(const Camera& camera, const std::string& name = {});  // the first one is the default of renderers
  // A scene without an environment gets the default one, unless it has a punctual light, or emissive surfaces that light at
  // least half of its surfaces. A black environment counts as one.
  void setEnvironment(const Environment& environment);
  // An equirectangular image. `maxMemory`: LoadOptions. Throws FileError, MemoryError.
  void setEnvironment(const std::filesystem::path& file, std::size_t maxMemory = 0);

  // Replaces a material. Its geometries get tangents for a normal map if they have none, and keep those that they have.
  void setMaterial(int index, const Material& material);
  void setTransform(int instance,
                    const Transform& worldFromObject);  // replaces a transform; it is not animated afterwards

  std::string name() const;                                      // of the file; empty for a scene from memory
  std::size_t meshCount() const;                                 // number of meshes
  std::size_t materialCount() const;                             // number of materials
  std::size_t instanceCount() const;                             // number of instances
  std::size_t lightCount() const;                                // number of lights without area
  std::size_t cameraCount() const;                               // number of cameras
  Material material(int index) const;                            // throws UsageError
  Transform transform(int instance) const;                       // at frame 0; throws UsageError
  std::optional<int> findInstance(std::string_view name) const;  // the first with this name
  std::optional<int> findMaterial(std::string_view name) const;  // the first with this name
  SceneReport report() const;                                    // of the file; empty for a scene from memory
  Bounds bounds() const;                                         // world space; empty for a scene without instances

 private:
  friend class Renderer;
  friend std::vector<Diagnostic> checkProgram(const Program&, const Scene*);
  struct Impl;
  Impl& change();      // not shared with other copies
  Impl& impl() const;  // throws UsageError for an empty object
  std::shared_ptr<Impl> impl_;
};

}  // namespace quintet
#endif
