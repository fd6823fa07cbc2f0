// SPDX-License-Identifier: Apache-2.0
#include "scene/model/content_hash.h"

#include <type_traits>

namespace quintet::scene {
namespace {

// These are hashed as bytes, so they must not have padding.
static_assert(sizeof(Primitive) == 3 * 4 + sizeof(mat4) && sizeof(CsgNode) == 8 && sizeof(CsgTree) == 8);
static_assert(sizeof(Bounds3) == 24 && sizeof(Keyframe) == 44);
static_assert(sizeof(AnimationChannel) == 8 + sizeof(std::size_t));
static_assert(sizeof(AnimatedValue) == 2 * sizeof(std::size_t));

// Hashes values field by field, because most structs have padding. The length of a vector precedes its elements.
class Feeder {
 public:
  template <class... Ts>
  Feeder& operator()(const Ts&... values) {
    (add(values), ...);
    return *this;
  }
  Hash finish() const { return hasher_.finish(); }

 private:
  void add(const std::string& text) { hasher_.add(std::string_view(text)); }
  template <class T>
  void add(const std::vector<T>& values) {
    hasher_.add(static_cast<std::uint64_t>(values.size()));
    if constexpr (std::is_class_v<T> && !std::is_trivially_copyable_v<T>) {
      for (const T& value : values) add(value);
    } else {
      hasher_.add(std::as_bytes(std::span(values)));
    }
  }
  template <class T, std::size_t N>
  void add(const std::array<T, N>& values) {
    for (const T& value : values) add(value);
  }
  template <class T>
  requires std::is_arithmetic_v<T> || std::is_enum_v<T>
  void add(const T& value) { hasher_.add(std::as_bytes(std::span(&value, 1))); }
  template <glm::length_t N, class T, glm::qualifier Q>
  void add(const glm::vec<N, T, Q>& value) {
    for (glm::length_t i = 0; i < N; ++i) add(value[i]);
  }
  void add(const mat4& value) {
    for (glm::length_t i = 0; i < 4; ++i) add(value[i]);
  }

  void add(const TextureUse& u) { (*this)(u.texture, u.uvSet, u.offset, u.scale, u.rotation); }
  void add(const Texture& t) { (*this)(t.name, t.image, t.sampler.wrapU, t.sampler.wrapV, t.sampler.filter); }
  void add(const io::Image& i) { (*this)(i.width, i.height, i.channels, i.type, i.encoding, i.premultiplied, i.data); }
  void add(const NamedImage& i) { add(i.image); }  // the name is a path
  void add(const Material& m) {
    (*this)(m.name, m.baseColor, m.baseColorTexture, m.metallic, m.roughness, m.metallicRoughnessTexture,
            m.normalTexture, m.normalScale, m.occlusionTexture, m.occlusionStrength, m.emissive, m.emissiveTexture,
            m.alphaMode, m.alphaCutoff, m.doubleSided, m.unlit, m.ior, m.transmission, m.transmissionTexture,
            m.thickness, m.attenuationDistance, m.attenuationColor, m.specular, m.specularTexture, m.specularColor,
            m.specularColorTexture, m.clearcoat, m.clearcoatTexture, m.clearcoatRoughness, m.clearcoatRoughnessTexture,
            m.clearcoatNormalTexture, m.clearcoatNormalScale, m.sheenColor, m.sheenColorTexture, m.sheenRoughness,
            m.sheenRoughnessTexture, m.diffuseTransmission, m.diffuseTransmissionTexture, m.diffuseTransmissionColor,
            m.diffuseTransmissionColorTexture, m.anisotropy, m.anisotropyRotation, m.anisotropyTexture, m.iridescence,
            m.iridescenceTexture, m.iridescenceIor, m.iridescenceThicknessMinimum, m.iridescenceThicknessMaximum,
            m.iridescenceThicknessTexture, m.dispersion, m.multiscatterColor, m.scatterAnisotropy,
            m.dielectricPriority);
  }
  void add(const Geometry& g) {
    (*this)(g.positions, g.triangles, g.normals, g.tangents, g.uvs, g.colors, g.material, g.fileTriangles);
  }
  void add(const PrimitiveSet& s) { (*this)(s.name, s.kind, s.primitives, s.nodes, s.trees, s.boxes, s.material); }
  void add(const Mesh& m) {
    (*this)(m.name, m.geometries, m.primitiveSets);
    if (m.deformation) (*this)(m.deformation->node, m.deformation->skin, m.deformation->geometries);
  }
  void add(const MorphTarget& t) { (*this)(t.positions, t.normals, t.tangents); }
  void add(const SkinSet& s) { (*this)(s.joints, s.weights); }
  void add(const GeometryDeformation& d) {
    (*this)(d.positions, d.normals, d.tangents, d.faceNormals, d.targets, d.skinSets);
  }
  void add(const Instance& i) {
    (*this)(i.name, i.mesh, i.worldFromObject, i.mask, i.flags, i.customIndex, i.keyframes, i.animatedFromObject);
    if (i.interpolation != KeyframeInterpolation{})
      (*this)(i.interpolation.translation, i.interpolation.rotation, i.interpolation.scale);
    addNode(i.node);
    addNode(i.visibleNode);
    if (i.node != kNone) add(i.placedFromRoot);
  }
  void add(const Camera& c) {
    (*this)(c.name, c.orthographic, c.verticalFov, c.aspect, c.orthographicHalfSize, c.worldFromCamera,
            c.apertureRadius, c.focusDistance);
    addNode(c.node);
    if (c.node != kNone) add(c.placedFromRoot);
    if (!c.values.empty()) add(c.values);
  }
  void add(const Light& l) {
    (*this)(l.name, l.type, l.intensity, l.position, l.direction, l.innerConeAngle, l.outerConeAngle, l.range);
    addNode(l.node);
    addNode(l.visibleNode);
    if (l.node != kNone) add(l.placedFromRoot);
    if (!l.values.empty()) add(l.values);
  }
  // Without an animation, the hash is that of the file without its animations.
  void addNode(int node) {
    if (node != kNone) add(node);
  }
  template <glm::length_t N>
  void add(const glm::mat<N, N, double, glm::defaultp>& value) {
    for (glm::length_t i = 0; i < N; ++i) add(value[i]);
  }
  void add(const glm::dquat& q) { (*this)(q.w, q.x, q.y, q.z); }
  void add(const AnimationNode& n) {
    (*this)(n.parent, n.translation, n.rotation, n.scale, n.matrix, n.hasMatrix, n.weights, n.visible);
  }
  void add(const Skin& s) { (*this)(s.joints, s.inverseBindMatrices); }
  void add(const AnimationSampler& s) { (*this)(s.interpolation, s.times, s.values, s.valueSize); }
  void add(const AnimationChannel& c) { (*this)(c.node, c.property, c.sampler); }
  void add(const AnimatedMaterial& m) { (*this)(m.material, m.values); }
  void add(const std::shared_ptr<const NodeAnimation>& a) {
    if (!a) return;
    (*this)(a->nodes, a->skins, a->animation.samplers, a->animation.channels, a->framesPerSecond);
    (*this)(a->values, a->materials);
  }
  void add(const Environment& e) {
    (*this)(e.image, e.constant, e.intensity, e.rotation, e.present);
    if (!e.values.empty()) (*this)(e.values, e.animatedIntensityFactor, e.animatedRotationOffset);
  }

  Hasher hasher_;
};

}  // namespace

Hash contentHash(const Scene& scene) {
  Feeder feed;
  feed(scene.meshes, scene.instances, scene.materials, scene.textures, scene.images, scene.cameras, scene.lights,
       scene.environment, scene.nodeAnimation);
  return feed.finish();
}

Hash contentHash(const Environment& environment) {
  Feeder feed;
  feed(environment);
  return feed.finish();
}

}  // namespace quintet::scene
