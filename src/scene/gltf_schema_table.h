// The table itself: glTF 2.0 (Khronos, 2021, sections 5.1 to 5.29) and the extensions that Quintet reads.
// Ranges are here only where a value outside makes the data unusable; factors outside [0,1] are repaired
// by the material reader.
#ifndef QUINTET_SCENE_GLTF_SCHEMA_TABLE_H
#define QUINTET_SCENE_GLTF_SCHEMA_TABLE_H

#include "scene/gltf_schema.h"

namespace quintet::scene::schema {

inline constexpr double kMaxInt = 2147483647.0;
inline constexpr double kMaxBytes = 9007199254740991.0;  // 2^53 - 1: exact in JSON

inline constexpr Collection kAccessors{"/accessors", "accessor"};
inline constexpr Collection kBuffers{"/buffers", "buffer"};
inline constexpr Collection kBufferViews{"/bufferViews", "buffer view"};
inline constexpr Collection kCameras{"/cameras", "camera"};
inline constexpr Collection kImages{"/images", "image"};
inline constexpr Collection kLights{"/extensions/KHR_lights_punctual/lights", "light"};
inline constexpr Collection kMaterials{"/materials", "material"};
inline constexpr Collection kMeshes{"/meshes", "mesh"};
inline constexpr Collection kNodes{"/nodes", "node"};
inline constexpr Collection kSamplers{"/samplers", "sampler"};
inline constexpr Collection kScenes{"/scenes", "scene"};
inline constexpr Collection kSkins{"/skins", "skin"};
inline constexpr Collection kTextures{"/textures", "texture"};

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
constexpr Property required(Property property) {
  property.required = true;
  return property;
}

inline constexpr std::string_view kVectorTypes[] = {"SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4"};
inline constexpr std::string_view kCameraTypes[] = {"perspective", "orthographic"};
inline constexpr std::string_view kAlphaModes[] = {"OPAQUE", "MASK", "BLEND"};
inline constexpr std::string_view kMeshoptModes[] = {"ATTRIBUTES", "TRIANGLES", "INDICES"};
inline constexpr std::string_view kMeshoptFilters[] = {"NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL"};
inline constexpr int kComponentTypes[] = {5120, 5121, 5122, 5123, 5125, 5126};
inline constexpr int kIndexTypes[] = {5121, 5123, 5125};
inline constexpr int kModes[] = {0, 1, 2, 3, 4, 5, 6};
inline constexpr int kMagFilters[] = {9728, 9729};
inline constexpr int kWraps[] = {33071, 33648, 10497};

inline constexpr Property kAsset[] = {required(string("version")), string("minVersion"), string("generator"),
                                      string("copyright")};

inline constexpr Property kMeshoptFallback[] = {boolean("fallback")};
inline constexpr Property kBufferExtensions[] = {object("EXT_meshopt_compression", kMeshoptFallback)};
inline constexpr Property kBuffer[] = {required(integer("byteLength", 1, kMaxBytes)), string("uri"), string("name"),
                                       object("extensions", kBufferExtensions)};

inline constexpr Property kMeshoptView[] = {
    required(index("buffer", kBuffers)),     integer("byteOffset"),         required(integer("byteLength", 1)),
    required(integer("byteStride", 1, 256)), required(integer("count", 0)), required(choice("mode", kMeshoptModes)),
    choice("filter", kMeshoptFilters),
};
inline constexpr Property kViewExtensions[] = {object("EXT_meshopt_compression", kMeshoptView)};
inline constexpr Property kBufferView[] = {required(index("buffer", kBuffers)), integer("byteOffset", 0, kMaxBytes),
                                           required(integer("byteLength", 1, kMaxBytes)), integer("byteStride", 0, 252),
                                           object("extensions", kViewExtensions)};

inline constexpr Property kSparseIndices[] = {required(index("bufferView", kBufferViews)), integer("byteOffset"),
                                              required(oneOf("componentType", kIndexTypes))};
inline constexpr Property kSparseValues[] = {required(index("bufferView", kBufferViews)), integer("byteOffset")};
inline constexpr Property kSparse[] = {required(integer("count", 0)), required(object("indices", kSparseIndices)),
                                       required(object("values", kSparseValues))};
inline constexpr Property kAccessor[] = {
    index("bufferView", kBufferViews),
    integer("byteOffset", 0, kMaxBytes),
    required(integer("count", 0, 4294967295.0)),
    required(choice("type", kVectorTypes)),
    boolean("normalized"),
    required(oneOf("componentType", kComponentTypes)),
    object("sparse", kSparse),
};

inline constexpr Property kDraco[] = {required(index("bufferView", kBufferViews)), required(integerMap("attributes"))};
inline constexpr Property kPrimitiveExtensions[] = {object("KHR_draco_mesh_compression", kDraco)};
inline constexpr Property kPrimitive[] = {
    required(indexMap("attributes", kAccessors)),
    index("indices", kAccessors),
    index("material", kMaterials),
    oneOf("mode", kModes),
    indexMaps("targets", kAccessors),
    object("extensions", kPrimitiveExtensions),
};
inline constexpr Property kMesh[] = {required(objects("primitives", kPrimitive)), anyNumbers("weights"),
                                     string("name")};

inline constexpr Property kNodeLight[] = {required(index("light", kLights))};
inline constexpr Property kInstancing[] = {required(indexMap("attributes", kAccessors))};
inline constexpr Property kNodeExtensions[] = {object("KHR_lights_punctual", kNodeLight),
                                               object("EXT_mesh_gpu_instancing", kInstancing)};
inline constexpr Property kNode[] = {
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
inline constexpr Property kScene[] = {indices("nodes", kNodes), string("name")};
inline constexpr Property kSkin[] = {index("inverseBindMatrices", kAccessors), index("skeleton", kNodes),
                                     required(indices("joints", kNodes)), string("name")};

inline constexpr Property kTransform[] = {numbers("offset", 2), number("rotation"), numbers("scale", 2),
                                          integer("texCoord")};
inline constexpr Property kTextureUseExtensions[] = {object("KHR_texture_transform", kTransform)};
inline constexpr Property kTextureUse[] = {required(index("index", kTextures)), integer("texCoord"), number("scale"),
                                           number("strength"), object("extensions", kTextureUseExtensions)};
constexpr Property texture(std::string_view name) { return object(name, kTextureUse); }

inline constexpr Property kMetallicRoughness[] = {numbers("baseColorFactor", 4), texture("baseColorTexture"),
                                                  number("metallicFactor"), number("roughnessFactor"),
                                                  texture("metallicRoughnessTexture")};
inline constexpr Property kEmissiveStrength[] = {number("emissiveStrength")};
inline constexpr Property kIor[] = {number("ior")};
inline constexpr Property kTransmission[] = {number("transmissionFactor"), texture("transmissionTexture")};
inline constexpr Property kVolume[] = {number("thicknessFactor"), texture("thicknessTexture"),
                                       number("attenuationDistance"), numbers("attenuationColor", 3)};
inline constexpr Property kSpecular[] = {number("specularFactor"), texture("specularTexture"),
                                         numbers("specularColorFactor", 3), texture("specularColorTexture")};
inline constexpr Property kClearcoat[] = {number("clearcoatFactor"), texture("clearcoatTexture"),
                                          number("clearcoatRoughnessFactor"), texture("clearcoatRoughnessTexture"),
                                          texture("clearcoatNormalTexture")};
inline constexpr Property kMaterialExtensions[] = {
    object("KHR_materials_unlit", {}),
    object("KHR_materials_emissive_strength", kEmissiveStrength),
    object("KHR_materials_ior", kIor),
    object("KHR_materials_transmission", kTransmission),
    object("KHR_materials_volume", kVolume),
    object("KHR_materials_specular", kSpecular),
    object("KHR_materials_clearcoat", kClearcoat),
};
inline constexpr Property kMaterial[] = {
    string("name"),
    object("pbrMetallicRoughness", kMetallicRoughness),
    texture("normalTexture"),
    texture("occlusionTexture"),
    texture("emissiveTexture"),
    numbers("emissiveFactor", 3),
    choice("alphaMode", kAlphaModes),
    number("alphaCutoff"),
    boolean("doubleSided"),
    object("extensions", kMaterialExtensions),
};

inline constexpr Property kImage[] = {index("bufferView", kBufferViews), string("uri"), string("mimeType"),
                                      string("name")};
inline constexpr Property kSampler[] = {oneOf("magFilter", kMagFilters), oneOf("wrapS", kWraps),
                                        oneOf("wrapT", kWraps)};
inline constexpr Property kWebp[] = {required(index("source", kImages))};
inline constexpr Property kTextureExtensions[] = {object("EXT_texture_webp", kWebp)};
inline constexpr Property kTexture[] = {index("sampler", kSamplers), index("source", kImages), string("name"),
                                        object("extensions", kTextureExtensions)};

inline constexpr Property kPerspective[] = {number("aspectRatio"), required(number("yfov")), required(number("znear")),
                                            number("zfar")};
inline constexpr Property kOrthographic[] = {required(number("xmag")), required(number("ymag")),
                                             required(number("znear")), required(number("zfar"))};
inline constexpr Property kCamera[] = {required(choice("type", kCameraTypes)), object("perspective", kPerspective),
                                       object("orthographic", kOrthographic), string("name")};

inline constexpr Property kSpot[] = {number("innerConeAngle"), number("outerConeAngle")};
inline constexpr Property kLight[] = {required(string("type")), numbers("color", 3),   number("intensity"),
                                      number("range"),          object("spot", kSpot), string("name")};
inline constexpr Property kRootLights[] = {required(objects("lights", kLight))};
inline constexpr Property kRootExtensions[] = {object("KHR_lights_punctual", kRootLights)};

inline constexpr Property kRoot[] = {
    required(object("asset", kAsset)),
    strings("extensionsUsed"),
    strings("extensionsRequired"),
    objects("accessors", kAccessor),
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

}  // namespace quintet::scene::schema
#endif
