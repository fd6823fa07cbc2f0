// SPDX-License-Identifier: Apache-2.0
#include "render/lights/light_emitters.h"

#include <array>
#include <cmath>
#include <optional>

#include "io/color.h"
#include "render/lights/luminance.h"
#include "scene/geometry/tangents.h"
#include "scene/model/surface_class.h"

namespace quintet::render {
namespace {

// ---- Emission textures ----

// Number of texels read for one triangle. Larger triangles use a coarser level.
constexpr double kMaxTexels = 4096.0;
// Weight of blocks that a triangle touches but whose center it does not contain.
constexpr double kBorderWeight = 0.125;

// Reads texels of any type as linear color.
class TexelReader {
 public:
  explicit TexelReader(const io::Image& image) : image_(image), srgb_(image.encoding == io::ColorEncoding::sRgb) {
    for (std::size_t i = 0; i < bytes_.size(); ++i) bytes_[i] = decode(static_cast<float>(i) / 255.0f);
  }
  vec3 operator()(std::size_t pixel) const {
    const std::size_t first = pixel * image_.channels;
    if (image_.channels < 3) return vec3(sample(first));
    return {sample(first), sample(first + 1), sample(first + 2)};
  }

 private:
  float decode(float v) const { return srgb_ ? io::linearFromSrgb(v) : v; }
  float sample(std::size_t i) const {
    switch (image_.type) {
      case io::PixelType::u8: return bytes_[image_.samples<std::uint8_t>()[i]];
      case io::PixelType::u16: return decode(static_cast<float>(image_.samples<std::uint16_t>()[i]) / 65535.0f);
      case io::PixelType::f32: return decode(image_.samples<float>()[i]);
    }
    return 0.0f;
  }
  const io::Image& image_;
  bool srgb_;
  std::array<float, 256> bytes_{};
};

long wrapped(long i, long size, scene::Wrap wrap) {
  if (wrap == scene::Wrap::clampToEdge) return std::clamp(i, 0L, size - 1);
  const long period = wrap == scene::Wrap::mirroredRepeat ? 2 * size : size;
  const long m = ((i % period) + period) % period;
  return m < size ? m : period - 1 - m;
}

// Tests a triangle in texel coordinates against axis-aligned boxes by separating axes. A degenerate triangle is
// replaced by its bounding box.
struct TexelTriangle {
  std::array<vec2, 3> p;
  std::array<vec2, 3> normal{};  // outward normals of the edges; 0 disables the test

  explicit TexelTriangle(const std::array<vec2, 3>& points) : p(points) {
    const vec2 e1 = p[1] - p[0], e2 = p[2] - p[0];
    const float twiceArea = e1.x * e2.y - e1.y * e2.x;
    if (std::abs(twiceArea) < 1e-6f * (glm::dot(e1, e1) + glm::dot(e2, e2))) return;
    for (std::size_t i = 0; i < 3; ++i) {
      const vec2 edge = p[(i + 1) % 3] - p[i];
      normal[i] = twiceArea > 0.0f ? vec2(edge.y, -edge.x) : vec2(-edge.y, edge.x);
    }
  }
  bool touches(vec2 center, vec2 halfSize) const {
    for (std::size_t i = 0; i < 3; ++i)
      if (glm::dot(normal[i], center - p[i]) > glm::dot(glm::abs(normal[i]), halfSize)) return false;
    return true;
  }
};

// The luminance of a material's emission with its texture, as a pyramid of box-filtered levels.
class EmissionMap {
 public:
  EmissionMap(const scene::Scene& scene, const scene::Material& material);

  // Returns whether the emission is 0 everywhere. Such a material is not an emitter.
  bool black() const { return factor_ <= 0.0f && mean_ <= 0.0f; }
  int uvSet() const { return use_.uvSet; }

  // Returns the mean over the triangle with these texture coordinates, to which the texture's transform is yet to be
  // applied. All texels that bilinear interpolation can show on the triangle contribute, so the mean is 0 only if the
  // whole triangle is black.
  float meanOver(vec2 a, vec2 b, vec2 c) const;

 private:
  struct Level {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::vector<float> luminance;
  };
  // Appends all coarser levels to levels_[0].
  void filterLevels();
  vec2 texelPosition(vec2 uv) const;
  float blockAt(const Level& level, int shift, long x, long y) const;

  scene::TextureUse use_;
  scene::Sampler sampler_;
  float factor_ = 0.0f;        // luminance of a material without texture
  float mean_ = 0.0f;          // mean of the whole texture
  std::vector<Level> levels_;  // level i + 1 has half the size, rounded up; empty for a material without texture
};

EmissionMap::EmissionMap(const scene::Scene& scene, const scene::Material& material)
    : use_(material.emissiveTexture), factor_(lightLuminance(material.emissive)) {
  if (!use_.used() || factor_ <= 0.0f) return;
  const scene::Texture& texture = scene.textures[use_.texture];
  if (texture.image == scene::kNone) return;
  const io::Image& image = scene.images[texture.image].image;
  if (image.empty()) return;
  sampler_ = texture.sampler;
  levels_.push_back({image.width, image.height, std::vector<float>(image.pixelCount())});
  const TexelReader reader(image);
  parallelFor(image.height, [&](std::size_t y) {
    for (std::size_t i = y * image.width; i < (y + 1) * image.width; ++i)
      levels_[0].luminance[i] = lightLuminance(material.emissive * reader(i));
  });
  filterLevels();
  mean_ = levels_.back().luminance[0];
  factor_ = 0.0f;
}

void EmissionMap::filterLevels() {
  while (levels_.back().width > 1 || levels_.back().height > 1) {
    const Level& fine = levels_.back();
    Level coarse{(fine.width + 1) / 2, (fine.height + 1) / 2, {}};
    coarse.luminance.reserve(static_cast<std::size_t>(coarse.width) * coarse.height);
    for (std::size_t y = 0; y < coarse.height; ++y)
      for (std::size_t x = 0; x < coarse.width; ++x) {
        const std::size_t x1 = std::min<std::size_t>(2 * x + 1, fine.width - 1);
        const std::size_t y0 = 2 * y * fine.width, y1 = std::min<std::size_t>(2 * y + 1, fine.height - 1) * fine.width;
        coarse.luminance.push_back(0.25f * (fine.luminance[y0 + 2 * x] + fine.luminance[y0 + x1] +
                                            fine.luminance[y1 + 2 * x] + fine.luminance[y1 + x1]));
      }
    levels_.push_back(std::move(coarse));
  }
}

vec2 EmissionMap::texelPosition(vec2 uv) const {
  return scene::transformUv(use_, uv) * vec2(levels_[0].width, levels_[0].height);
}

float EmissionMap::blockAt(const Level& level, int shift, long x, long y) const {
  const long u = wrapped(x << shift, levels_[0].width, sampler_.wrapU) >> shift;
  const long v = wrapped(y << shift, levels_[0].height, sampler_.wrapV) >> shift;
  return level.luminance[static_cast<std::size_t>(v) * level.width + static_cast<std::size_t>(u)];
}

float EmissionMap::meanOver(vec2 a, vec2 b, vec2 c) const {
  if (levels_.empty()) return factor_;
  const std::array<vec2, 3> points{texelPosition(a), texelPosition(b), texelPosition(c)};
  // A texel contributes up to one texel from its center, which is half a texel beyond its square.
  const vec2 low = glm::min(glm::min(points[0], points[1]), points[2]) - 0.5f;
  const vec2 high = glm::max(glm::max(points[0], points[1]), points[2]) + 0.5f;
  const vec2 reach = glm::max(glm::abs(low), glm::abs(high));
  if (!(reach.x < 1e8f && reach.y < 1e8f)) return mean_;
  int shift = 0;
  const auto blocks = [&](float length) { return length / std::ldexp(1.0, shift) + 2.0; };
  while (blocks(high.x - low.x) * blocks(high.y - low.y) > kMaxTexels) ++shift;
  if (shift >= static_cast<int>(levels_.size())) return mean_;

  const TexelTriangle triangle(points);
  const Level& level = levels_[shift];
  const float size = std::ldexp(1.0f, shift);
  const vec2 halfSize(0.5f * size + 0.5f);
  double sum = 0.0;
  double weights = 0.0;
  for (long y = std::lround(std::floor(low.y / size)); y <= std::lround(std::floor(high.y / size)); ++y)
    for (long x = std::lround(std::floor(low.x / size)); x <= std::lround(std::floor(high.x / size)); ++x) {
      const vec2 center = size * (vec2(x, y) + 0.5f);
      if (!triangle.touches(center, halfSize)) continue;
      const double weight = triangle.touches(center, vec2(0.0f)) ? 1.0 : kBorderWeight;
      sum += weight * blockAt(level, shift, x, y);
      weights += weight;
    }
  const float result = weights > 0.0 ? static_cast<float>(sum / weights) : mean_;
  // Coarse blocks are not aligned with a repeated texture of odd size and can miss a bright texel.
  return shift == 0 ? result : std::max(result, 1e-3f * mean_);
}

// ---- Areas of solids ----

using glm::dmat3;
using glm::dvec3;

constexpr double kTwoPi = 2.0 * glm::pi<double>();

// Returns the area to which m maps a unit area with unit normal n.
double stretch(const dmat3& m, const dvec3& n) {
  return glm::length(n.x * glm::cross(m[1], m[2]) + n.y * glm::cross(m[2], m[0]) + n.z * glm::cross(m[0], m[1]));
}

// Returns whether m is a similarity transform.
bool isSimilarity(const dmat3& m) {
  const dvec3 squares(glm::dot(m[0], m[0]), glm::dot(m[1], m[1]), glm::dot(m[2], m[2]));
  const double mixed =
      std::max({std::abs(glm::dot(m[0], m[1])), std::abs(glm::dot(m[1], m[2])), std::abs(glm::dot(m[2], m[0]))});
  return std::max({std::abs(squares.y - squares.x), std::abs(squares.z - squares.x), mixed}) < 1e-5 * squares.x;
}

// Returns the mean of body(x, z) over the unit circle around y.
template <class Body>
double meanAround(const Body& body) {
  constexpr int kSteps = 32;
  double sum = 0.0;
  for (int i = 0; i < kSteps; ++i) sum += body(std::sin(kTwoPi * i / kSteps), std::cos(kTwoPi * i / kSteps));
  return sum / kSteps;
}

template <class StretchOf>
double canonicalArea(const scene::Primitive& primitive, const StretchOf& at) {
  constexpr int kSteps = 16;
  const double cap = kTwoPi / 2.0 * at({0, 1, 0});
  switch (primitive.type) {
    case scene::PrimitiveType::box: return 8.0 * (at({1, 0, 0}) + at({0, 1, 0}) + at({0, 0, 1}));
    case scene::PrimitiveType::cylinder:
      return 2.0 * cap + 2.0 * kTwoPi * meanAround([&](double x, double z) { return at({x, 0, z}); });
    case scene::PrimitiveType::cone:
      return cap + 0.5 * kTwoPi * std::sqrt(5.0) *
                       meanAround([&](double x, double z) { return at(dvec3(2 * x, 1, 2 * z) / std::sqrt(5.0)); });
    case scene::PrimitiveType::sphere: {
      double sum = 0.0;  // slices of equal height have equal area
      for (int i = 0; i < kSteps; ++i) {
        const double y = (2.0 * i + 1.0) / kSteps - 1.0, r = std::sqrt(1.0 - y * y);
        sum += meanAround([&](double x, double z) { return at({r * x, y, r * z}); });
      }
      return 2.0 * kTwoPi * sum / kSteps;
    }
    case scene::PrimitiveType::torus: {
      const auto minor = static_cast<double>(primitive.parameter);
      double sum = 0.0;
      for (int i = 0; i < kSteps; ++i) {
        const double c = std::cos(kTwoPi * i / kSteps), s = std::sin(kTwoPi * i / kSteps);
        sum += (1.0 + minor * c) * meanAround([&](double x, double z) { return at({c * x, s, c * z}); });
      }
      return kTwoPi * kTwoPi * minor * sum / kSteps;
    }
  }
  return 0.0;
}

// ---- Emitters of a scene ----

// Adds the triangles of a geometry, which all have one material.
void addTriangles(Emitter& emitter, const scene::Geometry& geometry, const EmissionMap& map) {
  emitter.triangles = emitter.ownTriangles ? emitter.ownTriangles.get() : &geometry;
  if (map.black()) return;
  emitter.luminance.resize(geometry.triangles.size());
  const std::vector<vec2>& uvs = geometry.uvs[static_cast<std::size_t>(map.uvSet())];
  forManyInParallel(geometry.triangles.size(), [&](std::size_t i) {
    const uvec3 t = geometry.triangles[i];
    const auto uv = [&](std::uint32_t vertex) { return uvs.empty() ? vec2(0.0f) : uvs[vertex]; };
    emitter.luminance[i] = map.meanOver(uv(t.x), uv(t.y), uv(t.z));
  });
  emitter.black = std::ranges::all_of(emitter.luminance, [](float l) { return l <= 0.0f; });
}

bool uses(const scene::PrimitiveSet& set, int material) {
  return std::ranges::find(set.primitives, material, &scene::Primitive::material) != set.primitives.end();
}

// Adds the solids of one material of a primitive set.
void addSolids(Emitter& emitter, const scene::PrimitiveSet& set, int material, const EmissionMap& map) {
  emitter.solids = emitter.ownSolids ? emitter.ownSolids.get() : &set;
  emitter.luminance.resize(set.primitives.size(), 0.0f);
  const float mean = 0.5f * (map.meanOver({0, 0}, {1, 0}, {1, 1}) + map.meanOver({0, 0}, {1, 1}, {0, 1}));
  for (std::size_t i = 0; i < set.primitives.size(); ++i)
    if (set.primitives[i].material == material) emitter.luminance[i] = mean;
  emitter.black = emitter.black && mean <= 0.0f;
}

// Whether rays meet all of an instance with this material, whatever its alpha.
bool isForcedOpaque(const scene::Scene& scene, std::size_t material) {
  const auto index = static_cast<int>(material);
  return std::ranges::any_of(scene.instances, [&](const scene::Instance& instance) {
    if ((instance.flags & scene::kInstanceForceOpaque) == 0 || instance.mesh == scene::kNone) return false;
    const scene::Mesh& mesh = scene.meshes[static_cast<std::size_t>(instance.mesh)];
    return std::ranges::find(mesh.geometries, index, &scene::Geometry::material) != mesh.geometries.end() ||
           std::ranges::any_of(mesh.primitiveSets, [&](const scene::PrimitiveSet& set) { return uses(set, index); });
  });
}

// The material with its largest emission during the animation, so that each triangle that can emit is a light.
scene::Material brightestState(const scene::Scene& scene, std::size_t material) {
  scene::Material brightest = scene.materials[material];
  if (material < scene.materialStates.size() && !scene.materialStates[material].empty()) {
    for (const scene::Material& state : scene.materialStates[material])
      brightest.emissive = glm::max(brightest.emissive, state.emissive);
  } else if (scene::isInvisible(brightest) && !isForcedOpaque(scene, material)) {
    brightest.emissive = vec3(0.0f);
  }
  return brightest;
}

// An emitter that must be computed, and its geometry or set of solids.
struct Pending {
  Emitter* emitter;
  const scene::Geometry* geometry = nullptr;
  const scene::PrimitiveSet* set = nullptr;
};

// Empties the emitters that have one of these materials, and returns them.
std::vector<Pending> discardEmitters(const scene::Scene& scene, const std::vector<bool>& materials,
                                     std::vector<std::vector<Emitter>>& emitters) {
  const auto affected = [&](int material) {
    return material != scene::kNone && materials[static_cast<std::size_t>(material)];
  };
  std::vector<Pending> pending;
  const auto discard = [&](Emitter& emitter, const scene::Geometry* geometry, const scene::PrimitiveSet* set) {
    emitter.luminance.clear();
    emitter.black = true;
    pending.push_back({&emitter, geometry, set});
  };
  emitters.resize(scene.meshes.size());
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    const scene::Mesh& mesh = scene.meshes[m];
    emitters[m].resize(mesh.geometryCount());
    for (std::size_t g = 0; g < mesh.geometries.size(); ++g)
      if (affected(mesh.geometries[g].material)) discard(emitters[m][g], &mesh.geometries[g], nullptr);
    for (std::size_t g = 0; g < mesh.primitiveSets.size(); ++g) {
      const scene::PrimitiveSet& set = mesh.primitiveSets[g];
      if (set.kind == scene::PrimitiveSetKind::solids &&
          std::ranges::any_of(set.primitives, affected, &scene::Primitive::material))
        discard(emitters[m][g], nullptr, &set);
    }
  }
  return pending;
}

}  // namespace

void Emitters::copyGeometry() {
  for (std::vector<Emitter>& mesh : emitters_)
    for (Emitter& emitter : mesh) {
      if (emitter.black) continue;
      if (emitter.triangles && !emitter.ownTriangles) {
        scene::Geometry copy;
        copy.positions = emitter.triangles->positions;
        copy.triangles = emitter.triangles->triangles;
        emitter.ownTriangles = std::make_shared<scene::Geometry>(std::move(copy));
        emitter.triangles = emitter.ownTriangles.get();
      }
      if (emitter.solids && !emitter.ownSolids) {
        emitter.ownSolids = std::make_shared<scene::PrimitiveSet>(*emitter.solids);
        emitter.solids = emitter.ownSolids.get();
      }
    }
}

void Emitters::setPositions(std::size_t mesh, std::size_t geometry, std::span<const vec3> positions) {
  const Emitter& emitter = emitters_[mesh][geometry];
  if (emitter.ownTriangles) std::ranges::copy(positions, emitter.ownTriangles->positions.begin());
}

bool Emitters::update(const scene::Scene& scene) {
  emissions_.resize(scene.materials.size());
  std::vector<bool> changed;
  for (std::size_t m = 0; m < scene.materials.size(); ++m) {
    const scene::Material material = brightestState(scene, m);
    const bool emits = !material.unlit && lightLuminance(material.emissive) > 0.0f;
    const Emission emission = emits ? Emission{material.emissive, material.emissiveTexture} : Emission{};
    changed.push_back(emission != emissions_[m]);
    emissions_[m] = emission;
  }
  const bool any = std::ranges::count(changed, true) > 0;
  if (!any && emitters_.size() == scene.meshes.size()) return false;
  const std::vector<Pending> pending = discardEmitters(scene, changed, emitters_);
  for (std::size_t m = 0; m < scene.materials.size(); ++m) {  // one emission map in memory at a time
    if (emissions_[m] == Emission{}) continue;
    std::optional<EmissionMap> map;
    for (const Pending& p : pending) {
      if (p.set ? !uses(*p.set, static_cast<int>(m)) : p.geometry->material != static_cast<int>(m)) continue;
      if (!map) map.emplace(scene, brightestState(scene, m));
      if (p.set)
        addSolids(*p.emitter, *p.set, static_cast<int>(m), *map);
      else
        addTriangles(*p.emitter, *p.geometry, *map);
    }
  }
  for (const Pending& p : pending)
    if (p.emitter->black) *p.emitter = {};  // frees the copy of the geometry
  return any;
}

double solidArea(const scene::Primitive& primitive, const dmat3& worldFromObject) {
  const dmat3 m = worldFromObject * dmat3(mat3(primitive.objectFromPrimitive));
  const bool similar = isSimilarity(m);
  const double scale = glm::dot(m[0], m[0]);
  const double area = similar ? scale * canonicalArea(primitive, [](const dvec3&) { return 1.0; })
                              : canonicalArea(primitive, [&](const dvec3& n) { return stretch(m, n); });
  return std::isfinite(area) ? area : 0.0;
}

double emitterArea(const Emitter& emitter, std::size_t i, const mat4& worldFromObject) {
  const glm::dmat3 linear{glm::mat3(worldFromObject)};
  if (emitter.solids) return solidArea(emitter.solids->primitives[i], linear);
  const uvec3& t = emitter.triangles->triangles[i];
  const glm::dvec3 p0 = emitter.triangles->positions[t.x];
  const glm::dvec3 edge1 = linear * (glm::dvec3(emitter.triangles->positions[t.y]) - p0);
  const glm::dvec3 edge2 = linear * (glm::dvec3(emitter.triangles->positions[t.z]) - p0);
  const double area = 0.5 * glm::length(glm::cross(edge1, edge2));
  return std::isfinite(area) ? area : 0.0;
}

LightBounds emitterBounds(const Emitter& emitter, std::size_t i, const mat4& worldFromObject, double area) {
  // The mean projected area of a convex body over all directions is a quarter of its surface area (Cauchy 1841).
  if (emitter.solids) return solidBounds(emitter.solids->primitives[i], worldFromObject, 0.25 * area);
  const uvec3& t = emitter.triangles->triangles[i];
  const std::vector<vec3>& p = emitter.triangles->positions;
  return triangleBounds({p[t.x], p[t.y], p[t.z]}, worldFromObject, area);
}

}  // namespace quintet::render
