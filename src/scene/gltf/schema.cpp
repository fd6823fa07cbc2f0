// SPDX-License-Identifier: Apache-2.0
#include "scene/gltf/schema.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "base/error.h"
#include "base/plural.h"
#include "base/text.h"

namespace quintet::scene {
namespace {

using nlohmann::json;

enum class PropertyKind {
  boolean,
  string,
  strings,
  integer,
  number,
  numbers,
  index,       // into `target`
  indices,     // array of indices
  indexLists,  // array of such arrays
  indexMap,    // object of indices: the attributes of a primitive
  indexMaps,   // array of such objects: morph targets
  integerMap,
  object,
  objects,
  any,     // of any type
  extras,  // of any type; the result has its numbers that the table names
  unread,  // of any type, and not in the result
};

// An array of the file that indices can point into.
struct Collection {
  const char* pointer;  // JSON pointer
  const char* noun;     // for messages
};

struct Property {
  std::string_view name;
  PropertyKind kind;
  bool required = false;
  double low = -std::numeric_limits<double>::infinity();  // integer, number, and each element of numbers
  double high = std::numeric_limits<double>::infinity();
  std::size_t minCount = 0;  // numbers
  std::size_t maxCount = std::numeric_limits<std::size_t>::max();
  const Collection* target = nullptr;
  std::span<const Property> object{};           // object, objects: its members
  std::span<const std::string_view> choices{};  // string
  std::span<const int> values{};                // integer
  std::string_view reason{};  // why it has no effect on the image; empty if it has, or if the report needs no line
};

// ---- The table: glTF 2.0 (Khronos, 2021, sections 5.1 to 5.29) and the supported extensions ----
//
// A range is given only where a value outside makes the data unusable. The material reader clamps factors to [0,1].

constexpr double kMaxInt = 2147483647.0;
constexpr double kMaxFloat = std::numeric_limits<float>::max();
constexpr double kMaxBytes = 9007199254740991.0;  // 2^53 - 1: exact in JSON

constexpr Collection kAccessors{"/accessors", "accessor"};
constexpr Collection kBuffers{"/buffers", "buffer"};
constexpr Collection kBufferViews{"/bufferViews", "buffer view"};
constexpr Collection kCameras{"/cameras", "camera"};
constexpr Collection kImages{"/images", "image"};
constexpr Collection kLights{"/extensions/KHR_lights_punctual/lights", "light"};
constexpr Collection kImageLights{"/extensions/EXT_lights_image_based/lights", "image-based light"};
constexpr Collection kMaterials{"/materials", "material"};
constexpr Collection kMeshes{"/meshes", "mesh"};
constexpr Collection kNodes{"/nodes", "node"};
constexpr Collection kSamplers{"/samplers", "sampler"};
constexpr Collection kScenes{"/scenes", "scene"};
constexpr Collection kSkins{"/skins", "skin"};
constexpr Collection kPackets{"/extensions/KHR_xmp_json_ld/packets", "metadata packet"};
constexpr Collection kTextures{"/textures", "texture"};
constexpr Collection kVariantNames{"/extensions/KHR_materials_variants/variants", "variant"};

using List = std::span<const Property>;

constexpr Property boolean(std::string_view name) { return {.name = name, .kind = PropertyKind::boolean}; }
constexpr Property string(std::string_view name) { return {.name = name, .kind = PropertyKind::string}; }
constexpr Property strings(std::string_view name) { return {.name = name, .kind = PropertyKind::strings}; }
constexpr Property choice(std::string_view name, std::span<const std::string_view> choices) {
  return {.name = name, .kind = PropertyKind::string, .choices = choices};
}
constexpr Property integer(std::string_view name, double low = 0, double high = kMaxInt) {
  return {.name = name, .kind = PropertyKind::integer, .low = low, .high = high};
}
constexpr Property oneOf(std::string_view name, std::span<const int> values) {
  return {.name = name, .kind = PropertyKind::integer, .values = values};
}
constexpr Property number(std::string_view name) { return {.name = name, .kind = PropertyKind::number}; }
constexpr Property numbers(std::string_view name, std::size_t count) {
  return {.name = name, .kind = PropertyKind::numbers, .minCount = count, .maxCount = count};
}
constexpr Property anyNumbers(std::string_view name) { return {.name = name, .kind = PropertyKind::numbers}; }
constexpr Property index(std::string_view name, const Collection& target) {
  return {.name = name, .kind = PropertyKind::index, .target = &target};
}
constexpr Property indices(std::string_view name, const Collection& target) {
  return {.name = name, .kind = PropertyKind::indices, .target = &target};
}
constexpr Property indexLists(std::string_view name, const Collection& target) {
  return {.name = name, .kind = PropertyKind::indexLists, .target = &target};
}
constexpr Property indexMap(std::string_view name, const Collection& target) {
  return {.name = name, .kind = PropertyKind::indexMap, .target = &target};
}
constexpr Property indexMaps(std::string_view name, const Collection& target) {
  return {.name = name, .kind = PropertyKind::indexMaps, .target = &target};
}
constexpr Property integerMap(std::string_view name) {
  return {.name = name, .kind = PropertyKind::integerMap, .low = 0, .high = kMaxInt};
}
constexpr Property object(std::string_view name, List inside) {
  return {.name = name, .kind = PropertyKind::object, .object = inside};
}
constexpr Property objects(std::string_view name, List inside) {
  return {.name = name, .kind = PropertyKind::objects, .object = inside};
}
// A property that cannot change the image.
constexpr Property noEffect(std::string_view name, std::string_view reason) {
  return {.name = name, .kind = PropertyKind::unread, .reason = reason};
}
// The same for a property whose value is checked.
constexpr Property withoutEffect(Property property, std::string_view reason) {
  property.reason = reason;
  return property;
}
// A property without content of its own, or one that another part of the importer reports.
constexpr Property unreported(std::string_view name) { return noEffect(name, {}); }
constexpr Property required(Property property) {
  property.required = true;
  return property;
}

constexpr std::string_view kVectorTypes[] = {"SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4"};
constexpr std::string_view kCameraTypes[] = {"perspective", "orthographic"};
constexpr std::string_view kAlphaModes[] = {"OPAQUE", "MASK", "BLEND"};
constexpr std::string_view kMeshoptModes[] = {"ATTRIBUTES", "TRIANGLES", "INDICES"};
constexpr std::string_view kMeshoptFilters[] = {"NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL", "COLOR"};
constexpr auto kOldMeshoptFilters = std::span(kMeshoptFilters).first<4>();
constexpr int kComponentTypes[] = {5120, 5121, 5122, 5123, 5125, 5126};
constexpr int kIndexTypes[] = {5121, 5123, 5125};
constexpr int kModes[] = {0, 1, 2, 3, 4, 5, 6};
constexpr int kMagFilters[] = {9728, 9729};
constexpr int kWraps[] = {33071, 33648, 10497};

constexpr Property kMetadata[] = {required(index("packet", kPackets))};
constexpr Property metadata() { return object("KHR_xmp_json_ld", kMetadata); }
constexpr Property kOnlyMetadata[] = {metadata()};
constexpr Property kAsset[] = {required(string("version")), string("minVersion"), string("generator"),
                               string("copyright"), object("extensions", kOnlyMetadata)};

constexpr Property kMeshoptFallback[] = {boolean("fallback")};
constexpr Property kBufferExtensions[] = {object("KHR_meshopt_compression", kMeshoptFallback),
                                          object("EXT_meshopt_compression", kMeshoptFallback)};
constexpr Property kBuffer[] = {required(integer("byteLength", 1, kMaxBytes)), string("uri"), string("name"),
                                object("extensions", kBufferExtensions)};

constexpr std::array<Property, 7> meshoptView(std::span<const std::string_view> filters) {
  return {required(index("buffer", kBuffers)),
          integer("byteOffset"),
          required(integer("byteLength", 1)),
          required(integer("byteStride", 1, 256)),
          required(integer("count", 0)),
          required(choice("mode", kMeshoptModes)),
          choice("filter", filters)};
}
constexpr auto kMeshoptView = meshoptView(kMeshoptFilters), kOldMeshoptView = meshoptView(kOldMeshoptFilters);
constexpr Property kViewExtensions[] = {object("KHR_meshopt_compression", kMeshoptView),
                                        object("EXT_meshopt_compression", kOldMeshoptView)};
constexpr Property kBufferView[] = {required(index("buffer", kBuffers)),
                                    integer("byteOffset", 0, kMaxBytes),
                                    required(integer("byteLength", 1, kMaxBytes)),
                                    integer("byteStride", 0, 252),
                                    object("extensions", kViewExtensions),
                                    unreported("name"),
                                    noEffect("target", "a hint for vertex buffers of rasterizers")};

constexpr Property kSparseIndices[] = {required(index("bufferView", kBufferViews)), integer("byteOffset"),
                                       required(oneOf("componentType", kIndexTypes))};
constexpr Property kSparseValues[] = {required(index("bufferView", kBufferViews)), integer("byteOffset")};
constexpr Property kSparse[] = {required(integer("count", 0)), required(object("indices", kSparseIndices)),
                                required(object("values", kSparseValues))};
constexpr Property kAccessor[] = {
    index("bufferView", kBufferViews),
    integer("byteOffset", 0, kMaxBytes),
    required(integer("count", 0, 4294967295.0)),
    required(choice("type", kVectorTypes)),
    boolean("normalized"),
    required(oneOf("componentType", kComponentTypes)),
    object("sparse", kSparse),
    noEffect("min", "bounds are computed from the data"),
    noEffect("max", "bounds are computed from the data"),
    unreported("name"),
};

constexpr Property kDraco[] = {required(index("bufferView", kBufferViews)), required(integerMap("attributes"))};
constexpr Property kVariantMapping[] = {required(index("material", kMaterials)),
                                        required(indices("variants", kVariantNames)), unreported("name")};
constexpr Property kVariantMappings[] = {required(objects("mappings", kVariantMapping))};
constexpr Property kPrimitiveExtensions[] = {object("KHR_draco_mesh_compression", kDraco),
                                             object("KHR_materials_variants", kVariantMappings)};
constexpr Property kPrimitive[] = {
    required(indexMap("attributes", kAccessors)),
    index("indices", kAccessors),
    index("material", kMaterials),
    oneOf("mode", kModes),
    indexMaps("targets", kAccessors),
    object("extensions", kPrimitiveExtensions),
};
constexpr Property kMesh[] = {required(objects("primitives", kPrimitive)), anyNumbers("weights"), string("name"),
                              object("extensions", kOnlyMetadata)};

constexpr Property kVisibility[] = {boolean("visible")};
constexpr Property kNodeLight[] = {required(index("light", kLights))};
constexpr Property kInstancing[] = {required(indexMap("attributes", kAccessors))};
constexpr Property kNodeExtensions[] = {object("KHR_lights_punctual", kNodeLight),
                                        object("EXT_mesh_gpu_instancing", kInstancing),
                                        object("KHR_node_visibility", kVisibility), metadata()};
constexpr Property kNode[] = {
    index("camera", kCameras),
    indices("children", kNodes),
    index("skin", kSkins),
    index("mesh", kMeshes),
    numbers("matrix", 16),
    numbers("rotation", 4),
    numbers("scale", 3),
    numbers("translation", 3),
    anyNumbers("weights"),
    string("name"),
    object("extensions", kNodeExtensions),
};
constexpr Property kSceneLight[] = {required(index("light", kImageLights))};
constexpr Property kSceneExtensions[] = {object("EXT_lights_image_based", kSceneLight), metadata()};
constexpr Property kScene[] = {indices("nodes", kNodes), string("name"), object("extensions", kSceneExtensions)};
constexpr Property kSkin[] = {index("inverseBindMatrices", kAccessors),
                              withoutEffect(index("skeleton", kNodes), "the joints determine the pose"),
                              required(indices("joints", kNodes)), string("name")};

constexpr Property kTransform[] = {numbers("offset", 2), number("rotation"), numbers("scale", 2), integer("texCoord")};
constexpr Property kTextureUseExtensions[] = {object("KHR_texture_transform", kTransform)};
constexpr Property kTextureUse[] = {required(index("index", kTextures)), integer("texCoord"), number("scale"),
                                    number("strength"), object("extensions", kTextureUseExtensions)};
constexpr Property texture(std::string_view name) { return object(name, kTextureUse); }

constexpr Property kMetallicRoughness[] = {numbers("baseColorFactor", 4), texture("baseColorTexture"),
                                           number("metallicFactor"), number("roughnessFactor"),
                                           texture("metallicRoughnessTexture")};
constexpr Property kEmissiveStrength[] = {number("emissiveStrength")};
constexpr Property kIor[] = {number("ior")};
constexpr Property kTransmission[] = {number("transmissionFactor"), texture("transmissionTexture")};
constexpr Property kVolume[] = {
    number("thicknessFactor"),
    withoutEffect(texture("thicknessTexture"), "a path tracer takes the thickness from the geometry"),
    number("attenuationDistance"), numbers("attenuationColor", 3)};
constexpr Property kSpecular[] = {number("specularFactor"), texture("specularTexture"),
                                  numbers("specularColorFactor", 3), texture("specularColorTexture")};
constexpr Property kClearcoat[] = {number("clearcoatFactor"), texture("clearcoatTexture"),
                                   number("clearcoatRoughnessFactor"), texture("clearcoatRoughnessTexture"),
                                   texture("clearcoatNormalTexture")};
constexpr Property kSheen[] = {numbers("sheenColorFactor", 3), texture("sheenColorTexture"),
                               number("sheenRoughnessFactor"), texture("sheenRoughnessTexture")};
constexpr Property kSpecularGlossiness[] = {numbers("diffuseFactor", 4), texture("diffuseTexture"),
                                            numbers("specularFactor", 3), number("glossinessFactor"),
                                            texture("specularGlossinessTexture")};
constexpr Property kDiffuseTransmission[] = {number("diffuseTransmissionFactor"), texture("diffuseTransmissionTexture"),
                                             numbers("diffuseTransmissionColorFactor", 3),
                                             texture("diffuseTransmissionColorTexture")};
constexpr Property kAnisotropy[] = {number("anisotropyStrength"), number("anisotropyRotation"),
                                    texture("anisotropyTexture")};
constexpr Property kIridescence[] = {number("iridescenceFactor"),
                                     texture("iridescenceTexture"),
                                     number("iridescenceIor"),
                                     number("iridescenceThicknessMinimum"),
                                     number("iridescenceThicknessMaximum"),
                                     texture("iridescenceThicknessTexture")};
constexpr Property kDispersion[] = {number("dispersion")};
constexpr Property kVolumeScatter[] = {numbers("multiscatterColor", 3), number("scatterAnisotropy")};
constexpr Property kMaterialExtensions[] = {
    object("KHR_materials_unlit", {}),
    object("KHR_materials_emissive_strength", kEmissiveStrength),
    object("KHR_materials_ior", kIor),
    object("KHR_materials_transmission", kTransmission),
    object("KHR_materials_volume", kVolume),
    object("KHR_materials_volume_scatter", kVolumeScatter),
    object("KHR_materials_specular", kSpecular),
    object("KHR_materials_clearcoat", kClearcoat),
    object("KHR_materials_sheen", kSheen),
    object("KHR_materials_diffuse_transmission", kDiffuseTransmission),
    object("KHR_materials_anisotropy", kAnisotropy),
    object("KHR_materials_iridescence", kIridescence),
    object("KHR_materials_dispersion", kDispersion),
    object("KHR_materials_pbrSpecularGlossiness", kSpecularGlossiness),
    metadata(),
};
constexpr std::string_view kApplicationData = "application-specific data";
constexpr Property kMaterialExtras[] = {number("dielectric_priority")};
constexpr Property kMaterial[] = {
    string("name"),
    object("pbrMetallicRoughness", kMetallicRoughness),
    texture("normalTexture"),
    withoutEffect(texture("occlusionTexture"), "a path tracer computes the occlusion"),
    texture("emissiveTexture"),
    numbers("emissiveFactor", 3),
    choice("alphaMode", kAlphaModes),
    number("alphaCutoff"),
    boolean("doubleSided"),
    object("extensions", kMaterialExtensions),
    {.name = "extras", .kind = PropertyKind::extras, .object = kMaterialExtras},
};

constexpr Property kImage[] = {index("bufferView", kBufferViews), string("uri"), string("mimeType"), string("name"),
                               object("extensions", kOnlyMetadata)};
constexpr Property kSampler[] = {
    oneOf("magFilter", kMagFilters), oneOf("wrapS", kWraps), oneOf("wrapT", kWraps),
    noEffect("minFilter", "there are no mip levels; many samples per pixel filter instead"), unreported("name")};
constexpr Property kWebp[] = {required(index("source", kImages))};
constexpr Property kBasisu[] = {required(index("source", kImages))};
constexpr Property kTextureExtensions[] = {object("EXT_texture_webp", kWebp), object("KHR_texture_basisu", kBasisu)};
constexpr Property kTexture[] = {index("sampler", kSamplers), index("source", kImages), string("name"),
                                 object("extensions", kTextureExtensions)};

constexpr std::string_view kNoClipping = "rays are not clipped to the depth range of a rasterizer";
constexpr Property kPerspective[] = {number("aspectRatio"), required(number("yfov")),
                                     withoutEffect(required(number("znear")), kNoClipping),
                                     withoutEffect(number("zfar"), kNoClipping)};
constexpr Property kOrthographic[] = {required(number("xmag")), required(number("ymag")),
                                      withoutEffect(required(number("znear")), kNoClipping),
                                      withoutEffect(required(number("zfar")), kNoClipping)};
constexpr Property kCamera[] = {required(choice("type", kCameraTypes)), object("perspective", kPerspective),
                                object("orthographic", kOrthographic), string("name")};

constexpr Property kSpot[] = {number("innerConeAngle"), number("outerConeAngle")};
constexpr Property kLight[] = {required(string("type")), numbers("color", 3),   number("intensity"),
                               number("range"),          object("spot", kSpot), string("name")};
constexpr Property kRootLights[] = {required(objects("lights", kLight))};
constexpr std::string_view kPrefiltered = "blurred light for rasterizers; a path tracer computes it";
constexpr Property kImageLight[] = {string("name"),
                                    numbers("rotation", 4),
                                    number("intensity"),
                                    noEffect("irradianceCoefficients", kPrefiltered),
                                    required(indexLists("specularImages", kImages)),
                                    noEffect("specularImageSize", "the images have their size")};
constexpr Property kRootImageLights[] = {required(objects("lights", kImageLight))};
constexpr Property kVariant[] = {required(string("name"))};
constexpr Property kRootVariants[] = {required(objects("variants", kVariant))};
constexpr Property kRootMetadata[] = {required({.name = "packets", .kind = PropertyKind::any})};
constexpr Property kRootExtensions[] = {
    object("KHR_lights_punctual", kRootLights), object("EXT_lights_image_based", kRootImageLights),
    object("KHR_xmp_json_ld", kRootMetadata), object("KHR_materials_variants", kRootVariants)};

constexpr std::string_view kInterpolations[] = {"LINEAR", "STEP", "CUBICSPLINE"};
constexpr Property kPointer[] = {required(string("pointer"))};
constexpr Property kTargetExtensions[] = {object("KHR_animation_pointer", kPointer)};
constexpr Property kAnimationTarget[] = {index("node", kNodes), required(string("path")),
                                         object("extensions", kTargetExtensions)};
constexpr Property kAnimationChannel[] = {required(integer("sampler")), required(object("target", kAnimationTarget))};
constexpr Property kAnimationSampler[] = {required(index("input", kAccessors)),
                                          choice("interpolation", kInterpolations),
                                          required(index("output", kAccessors))};
constexpr Property kAnimation[] = {required(objects("channels", kAnimationChannel)),
                                   required(objects("samplers", kAnimationSampler)), string("name")};

constexpr Property kRoot[] = {
    required(object("asset", kAsset)),
    strings("extensionsUsed"),
    strings("extensionsRequired"),
    objects("accessors", kAccessor),
    objects("animations", kAnimation),
    objects("buffers", kBuffer),
    objects("bufferViews", kBufferView),
    objects("cameras", kCamera),
    objects("images", kImage),
    objects("materials", kMaterial),
    objects("meshes", kMesh),
    objects("nodes", kNode),
    objects("samplers", kSampler),
    index("scene", kScenes),
    objects("scenes", kScene),
    objects("skins", kSkin),
    objects("textures", kTexture),
    object("extensions", kRootExtensions),
};

// ---- The check ----

// Location in the file, as a chain on the stack. It becomes a JSON pointer only for an error.
struct Location {
  const Location* parent = nullptr;
  std::string_view key{};
  std::size_t index = 0;

  std::string pointer() const {
    if (!parent) return {};
    std::string text = parent->pointer() + "/";
    if (key.data() == nullptr) return text + std::to_string(index);
    for (const char c : key) {
      if (c == '~')
        text += "~0";
      else if (c == '/')
        text += "~1";
      else
        text += c;
    }
    return text;
  }
  Location operator[](std::string_view name) const { return {this, name, 0}; }
  Location operator[](std::size_t i) const { return {this, {}, i}; }
};

class Checker {
 public:
  Checker(const std::filesystem::path& file, json& root) : file_(file), root_(root) {}

  CheckedSchema check() {
    result_.json = object(root_, kRoot, Location{});
    return std::move(result_);
  }

 private:
  json object(json& in, std::span<const Property> properties, const Location& location) {
    if (!in.is_object()) fail(location, "must be an object");
    json out = json::object();
    std::size_t known = 0;
    for (const Property& property : properties) {
      const auto found = in.find(property.name);
      if (found != in.end()) {
        ++known;
        const Location inside = location[property.name];
        noteUnread(UnreadProperty::Cause::noEffect, properties, inside, property.reason);
        if (property.kind == PropertyKind::unread) continue;
        if (property.kind == PropertyKind::extras) {
          out["extras"] = extras(*found, property, properties, inside);
          continue;
        }
        out[std::string(property.name)] = value(*found, property, inside);
        if (location.key == "extensions") noteExtension(inside);
      } else if (property.required) {
        fail(location, fmt::format("{} is missing", property.name));
      }
    }
    if (known < in.size()) noteUnknown(in, properties, location);
    return out;
  }

  // Application-specific data can be anything, so nothing in it is an error.
  json extras(const json& in, const Property& property, std::span<const Property> properties,
              const Location& location) {
    json out = json::object();
    for (const Property& member : property.object) {
      const auto found = in.is_object() ? in.find(member.name) : in.end();
      if (found != in.end() && found->is_number() && std::isfinite(found->get<float>()))
        out[std::string(member.name)] = found->get<double>();
    }
    if (!in.is_object() || out.size() < in.size())
      noteUnread(UnreadProperty::Cause::noEffect, properties, location, kApplicationData);
    return out;
  }

  // ---- What is not read ----

  void noteExtension(const Location& location) {
    ExtensionUse& use = result_.extensions[std::string(location.key)];
    if (use.count++ == 0) use.location = location.pointer();
  }

  // Equal properties of objects with the same table are counted together.
  void noteUnread(UnreadProperty::Cause cause, std::span<const Property> properties, const Location& location,
                  std::string_view reason) {
    if (cause == UnreadProperty::Cause::noEffect && reason.empty()) return;
    const auto [entry, isNew] =
        unread_.try_emplace(std::pair(properties.data(), std::string(location.key)), result_.unread.size());
    if (isNew)
      result_.unread.push_back({cause, std::string(location.key), location.pointer(), std::string(reason)});
    else
      ++result_.unread[entry->second].count;
  }

  void noteUnknown(const json& in, std::span<const Property> properties, const Location& location) {
    using Cause = UnreadProperty::Cause;
    for (const auto& [key, element] : in.items()) {
      if (std::ranges::find(properties, std::string_view(key), &Property::name) != properties.end()) continue;
      const Location inside = location[std::string_view(key)];
      if (key == "extras")
        noteUnread(Cause::noEffect, properties, inside, kApplicationData);
      else if (location.key == "extensions")
        noteUnread(Cause::extension, properties, inside, {});
      else if (key == "extensions" && element.is_object())
        for (const auto& [name, value] : element.items())
          noteUnread(Cause::extension, properties, inside[std::string_view(name)], {});
      else
        noteUnread(Cause::unknown, properties, inside, {});
    }
  }

  // ---- Values ----

  [[noreturn]] void fail(const Location& location, std::string_view problem) const {
    throw FileError(file_, printable(location.pointer()), printable(problem));
  }

  json value(json& in, const Property& property, const Location& location) {
    switch (property.kind) {
      case PropertyKind::boolean:
        if (!in.is_boolean()) fail(location, "must be true or false");
        return in;
      case PropertyKind::string: return string(in, property, location);
      case PropertyKind::integer: return integer(in, property, location);
      case PropertyKind::number: return number(in, property, location);
      case PropertyKind::numbers: return numbers(in, property, location);
      case PropertyKind::index: return index(in, property, location);
      case PropertyKind::object: return object(in, property.object, location);
      case PropertyKind::indexMap:
      case PropertyKind::integerMap: return map(in, property, location);
      case PropertyKind::strings:
      case PropertyKind::indices:
      case PropertyKind::indexLists:
      case PropertyKind::indexMaps:
      case PropertyKind::objects: return array(in, property, location);
      case PropertyKind::any: return std::move(in);
      case PropertyKind::extras:
      case PropertyKind::unread: break;
    }
    return {};
  }

  json string(json& in, const Property& property, const Location& location) const {
    if (!in.is_string()) fail(location, "must be a string");
    const auto& text = in.get_ref<const std::string&>();
    if (!property.choices.empty() && std::ranges::find(property.choices, text) == property.choices.end())
      fail(location,
           fmt::format("\"{}\" is unknown; available: {}", text.substr(0, 40), fmt::join(property.choices, ", ")));
    return std::move(in);
  }

  // 3.0 is accepted as 3, because some exporters write only floating-point numbers.
  static bool isIntegral(const json& in) {
    if (!in.is_number_float()) return in.is_number_integer();
    const double d = in.get<double>();
    return std::abs(d) <= kMaxBytes && d == std::floor(d);
  }

  json integer(const json& in, const Property& property, const Location& location) const {
    if (!isIntegral(in)) fail(location, "must be an integer");
    const double d = in.get<double>();
    if (!property.values.empty()) {
      if (std::ranges::none_of(property.values, [d](int v) { return v == d; }))
        fail(location, fmt::format("{} is not one of {}", d, fmt::join(property.values, ", ")));
    } else if (d < property.low || d > property.high) {
      fail(location, fmt::format("{} is not in the range from {} to {}", d, property.low, property.high));
    }
    // tinygltf reads counts only from unsigned numbers.
    if (d >= 0) return static_cast<std::uint64_t>(d);
    return static_cast<std::int64_t>(d);
  }

  json number(const json& in, const Property& property, const Location& location) const {
    if (!in.is_number()) fail(location, "must be a number");
    // Numbers beyond the range of float stand for "no limit": 1.8e308 is the largest one of JavaScript.
    const double d = std::clamp(in.get<double>(), -kMaxFloat, kMaxFloat);
    if (d < property.low || d > property.high)
      fail(location, fmt::format("{} is not in the range from {} to {}", d, property.low, property.high));
    return d;
  }

  json numbers(const json& in, const Property& property, const Location& location) const {
    if (!in.is_array()) fail(location, "must be an array of numbers");
    if (in.size() < property.minCount || in.size() > property.maxCount)
      fail(location, fmt::format("needs {}, has {}", counted(property.minCount, "number"), in.size()));
    json out = json::array();
    for (std::size_t i = 0; i < in.size(); ++i) out.push_back(number(in[i], property, location[i]));
    return out;
  }

  json index(const json& in, const Property& property, const Location& location) const {
    if (!isIntegral(in)) fail(location, "must be an integer");
    const double d = in.get<double>();
    const std::size_t size = sizeOf(*property.target);
    if (d < 0 || d >= static_cast<double>(size))
      fail(location, fmt::format("{} {} does not exist; the file has {}", property.target->noun, d, size));
    return static_cast<std::uint64_t>(d);
  }

  json indexList(const json& in, const Property& property, const Location& location) const {
    if (!in.is_array()) fail(location, "must be an array");
    json out = json::array();
    for (std::size_t i = 0; i < in.size(); ++i) out.push_back(index(in[i], property, location[i]));
    return out;
  }

  json map(const json& in, const Property& property, const Location& location) const {
    if (!in.is_object()) fail(location, "must be an object");
    json out = json::object();
    for (const auto& [key, element] : in.items()) {
      const Location inside = location[std::string_view(key)];
      out[key] = property.target ? index(element, property, inside) : integer(element, property, inside);
    }
    return out;
  }

  json array(json& in, const Property& property, const Location& location) {
    if (!in.is_array()) fail(location, "must be an array");
    json out = json::array();
    for (std::size_t i = 0; i < in.size(); ++i) {
      const Location inside = location[i];
      switch (property.kind) {
        case PropertyKind::strings: out.push_back(string(in[i], property, inside)); break;
        case PropertyKind::indices: out.push_back(index(in[i], property, inside)); break;
        case PropertyKind::indexLists: out.push_back(indexList(in[i], property, inside)); break;
        case PropertyKind::indexMaps: out.push_back(map(in[i], property, inside)); break;
        default: out.push_back(object(in[i], property.object, inside)); break;
      }
    }
    return out;
  }

  std::size_t sizeOf(const Collection& collection) const {
    const auto known = sizes_.find(&collection);
    if (known != sizes_.end()) return known->second;
    const json::json_pointer pointer(collection.pointer);
    const std::size_t size = root_.contains(pointer) && root_[pointer].is_array() ? root_[pointer].size() : 0;
    return sizes_[&collection] = size;
  }

  const std::filesystem::path& file_;
  json& root_;
  mutable std::map<const Collection*, std::size_t> sizes_;
  CheckedSchema result_;
  std::map<std::pair<const Property*, std::string>, std::size_t> unread_;  // index in result_.unread
};

}  // namespace

CheckedSchema checkSchema(const std::filesystem::path& file, json& root) { return Checker(file, root).check(); }

}  // namespace quintet::scene
