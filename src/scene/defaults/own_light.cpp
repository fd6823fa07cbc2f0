// SPDX-License-Identifier: Apache-2.0
#include "scene/defaults/own_light.h"

#include <algorithm>
#include <atomic>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "base/luminance.h"
#include "base/parallel.h"

namespace quintet::scene {
namespace {

constexpr std::size_t kReceivers = 256;        // points whose light is estimated
constexpr std::size_t kEmitters = 16;          // points on emissive triangles, and punctual lights, for each receiver
constexpr std::size_t kTrianglesPerBox = 256;  // consecutive triangles with common bounds
constexpr double kMaxBoxTests = 1e9;           // of a scene; very large ones have fewer receivers
constexpr float kShadowMargin = 1e-3f;         // of a shadow ray's length, at both ends

// The largest value at any time of the animation.
template <class Value>
float largestOverTime(const Scene& scene, int material, const Value& value) {
  if (material == kNone) return value(Material{});
  const auto m = static_cast<std::size_t>(material);
  float largest = value(scene.materials[m]);
  if (m < scene.materialStates.size())
    for (const Material& state : scene.materialStates[m]) largest = std::max(largest, value(state));
  return largest;
}

float emission(const Scene& scene, int material) {
  return largestOverTime(scene, material, [](const Material& m) { return luminance(m.emissive); });
}

float emissionWithoutTexture(const Scene& scene, int material) {
  return largestOverTime(scene, material, [](const Material& m) {
    return m.emissiveTexture.used() || m.unlit ? 0.0f : luminance(m.emissive);
  });
}

// Of the light of punctual lights: what the base color reflects in all directions. A metal reflects it the more widely, the
// rougher it is.
float reflectance(const Material& m) {
  const float metallic = m.metallicRoughnessTexture.used() ? 0.0f : m.metallic;
  const float transmission = m.transmissionTexture.used() ? 0.0f : m.transmission;
  const float spread = (1.0f - metallic) * (1.0f - transmission) + metallic * m.roughness * m.roughness;
  return luminance(vec3(m.baseColor)) * spread;
}

bool shines(const Light& light) { return luminance(light.intensity) > 0.0f || !light.values.empty(); }

bool castsShadow(const Material& m) {
  return m.alphaMode == AlphaMode::opaque && m.transmission == 0.0f && m.diffuseTransmission == 0.0f;
}

// A point of the R2 sequence (M. Roberts, "The Unreasonable Effectiveness of Quasirandom Sequences", 2018), in [0,1)².
glm::dvec2 quasirandom(std::size_t i) {
  const double n = static_cast<double>(i) + 1.0;
  return glm::fract(0.5 + n * glm::dvec2(0.7548776662466927, 0.5698402909980532));
}

std::array<glm::dvec3, 3> cornersOf(const Geometry& geometry, std::size_t triangle) {
  const uvec3& t = geometry.triangles[triangle];
  return {geometry.positions[t.x], geometry.positions[t.y], geometry.positions[t.z]};
}

// A geometry of a mesh in object space, shared by all instances of the mesh.
struct Surface {
  const Geometry* geometry;
  float emission = 0.0f;     // luminance
  float reflectance = 0.0f;  // of punctual lights
  bool doubleSided = false;
  bool castsShadow = true;
  std::vector<double> areas;   // cumulative, by triangle
  std::vector<Bounds3> boxes;  // of kTrianglesPerBox triangles each

  double area() const { return areas.empty() ? 0.0 : areas.back(); }
};

Surface surfaceOf(const Scene& scene, const Geometry& geometry) {
  const Material material =
      geometry.material == kNone ? Material{} : scene.materials[static_cast<std::size_t>(geometry.material)];
  Surface surface{&geometry, emissionWithoutTexture(scene, geometry.material), reflectance(material)};
  surface.doubleSided = material.doubleSided;
  surface.castsShadow = castsShadow(material);
  surface.areas.reserve(geometry.triangles.size());
  surface.boxes.resize((geometry.triangles.size() + kTrianglesPerBox - 1) / kTrianglesPerBox);
  double sum = 0.0;
  for (std::size_t i = 0; i < geometry.triangles.size(); ++i) {
    const auto p = cornersOf(geometry, i);
    const double area = 0.5 * glm::length(glm::cross(p[1] - p[0], p[2] - p[0]));
    if (std::isfinite(area)) sum += area;
    surface.areas.push_back(sum);
    for (const glm::dvec3& corner : p) surface.boxes[i / kTrianglesPerBox].extend(vec3(corner));
  }
  return surface;
}

// An instance of a surface.
struct Part {
  const Surface* surface;
  glm::dmat4 worldFromObject;
  glm::dmat4 objectFromWorld;
  double scale;  // by which areas change, exact for similarity transforms
};

struct Point {
  glm::dvec3 position;
  glm::dvec3 normal;  // unit, of the front side
  const Part* part;
};

// Distributes points over parts, in proportion to a weight per area.
class Distribution {
 public:
  template <class Weight>
  Distribution(std::span<const Part> parts, const Weight& weightOf) : parts_(parts) {
    for (const Part& part : parts) {
      total_ += part.surface->area() * part.scale * weightOf(*part.surface);
      sums_.push_back(total_);
    }
  }
  double total() const { return total_; }

  // The point at `position` in [0,1) of all, with a quasirandom position in its triangle.
  Point at(double position, std::size_t index) const {
    const auto last = [](const std::vector<double>& sums, double value) {
      const auto found = std::ranges::upper_bound(sums, value);
      return std::min(static_cast<std::size_t>(found - sums.begin()), sums.size() - 1);
    };
    const double value = position * total_;
    const std::size_t p = last(sums_, value);
    const Part& part = parts_[p];
    const double before = p > 0 ? sums_[p - 1] : 0.0;
    const double inside = (value - before) / (sums_[p] - before);
    const Surface& surface = *part.surface;
    const auto corners = cornersOf(*surface.geometry, last(surface.areas, inside * surface.area()));
    const glm::dvec2 u = quasirandom(index);
    const double root = std::sqrt(u.x);  // uniform in the triangle
    const glm::dvec3 object = (1.0 - root) * corners[0] + root * (1.0 - u.y) * corners[1] + root * u.y * corners[2];
    const glm::dmat3 linear(part.worldFromObject);
    glm::dvec3 normal = glm::cross(linear * (corners[1] - corners[0]), linear * (corners[2] - corners[0]));
    if (glm::determinant(linear) < 0.0) normal = -normal;  // mirrored: the front is still that of the object
    const double length = glm::length(normal);
    return {glm::dvec3(part.worldFromObject * glm::dvec4(object, 1.0)), length > 0.0 ? normal / length : normal, &part};
  }

 private:
  std::span<const Part> parts_;
  std::vector<double> sums_;
  double total_ = 0.0;
};

bool meets(const Bounds3& box, const vec3& origin, const vec3& inverse) {
  const vec3 a = (box.min - origin) * inverse, b = (box.max - origin) * inverse;
  const vec3 low = glm::min(a, b), high = glm::max(a, b);
  return std::max({low.x, low.y, low.z, kShadowMargin}) <= std::min({high.x, high.y, high.z, 1.0f - kShadowMargin});
}

// T. Möller and B. Trumbore, "Fast, Minimum Storage Ray-Triangle Intersection", 1997. Both sides block.
bool meets(const std::array<glm::dvec3, 3>& p, const glm::dvec3& origin, const glm::dvec3& segment) {
  const glm::dvec3 e1 = p[1] - p[0], e2 = p[2] - p[0];
  const glm::dvec3 h = glm::cross(segment, e2);
  const double determinant = glm::dot(e1, h);
  if (determinant == 0.0) return false;
  const glm::dvec3 s = (origin - p[0]) / determinant;
  const double u = glm::dot(s, h);
  const glm::dvec3 q = glm::cross(s, e1);
  const double v = glm::dot(segment, q);
  if (u < 0.0 || v < 0.0 || u + v > 1.0) return false;
  const double t = glm::dot(e2, q);
  return t > kShadowMargin && t < 1.0 - kShadowMargin;
}

bool blocks(const Part& part, const glm::dvec3& from, const glm::dvec3& to) {
  const Surface& surface = *part.surface;
  if (!surface.castsShadow) return false;
  const glm::dvec3 origin(part.objectFromWorld * glm::dvec4(from, 1.0));
  const glm::dvec3 segment = glm::dvec3(part.objectFromWorld * glm::dvec4(to, 1.0)) - origin;
  const vec3 inverse = 1.0f / vec3(segment);
  for (std::size_t b = 0; b < surface.boxes.size(); ++b) {
    if (!meets(surface.boxes[b], vec3(origin), inverse)) continue;
    const std::size_t end = std::min(surface.geometry->triangles.size(), (b + 1) * kTrianglesPerBox);
    for (std::size_t i = b * kTrianglesPerBox; i < end; ++i)
      if (meets(cornersOf(*surface.geometry, i), origin, segment)) return true;
  }
  return false;
}

// The light of a punctual light at a point: the position from which it comes, and the luminance of its irradiance at normal incidence.
struct Arrival {
  glm::dvec3 from;
  double irradiance;
};

Arrival arrivalOf(const Light& light, const glm::dvec3& point, double sceneSize) {
  const double intensity = luminance(light.intensity);
  const glm::dvec3 axis(light.direction);
  if (light.type == LightType::directional) return {point - axis * sceneSize, intensity};
  const glm::dvec3 from(light.position);
  const double square = glm::dot(point - from, point - from);
  if (!(square > 0.0) || square > double{light.range} * double{light.range}) return {from, 0.0};
  double part = 1.0;
  if (light.type == LightType::spot) {
    const double cosine = glm::dot(axis, point - from) / std::sqrt(square);
    const double outer = std::cos(double{light.outerConeAngle}), inner = std::cos(double{light.innerConeAngle});
    part = std::clamp((cosine - outer) / std::max(inner - outer, 1e-6), 0.0, 1.0);
    part *= part;  // KHR_lights_punctual
  }
  return {from, intensity * part / square};
}

// The surfaces of all meshes, their visible instances, and the punctual lights that shine.
struct World {
  std::vector<std::vector<Surface>> surfaces;  // by mesh
  std::vector<Part> parts;
  std::vector<const Light*> lights;
  double size = 0.0;  // the diagonal of the bounds

  explicit World(const Scene& scene) : surfaces(scene.meshes.size()) {
    for (const Light& light : scene.lights)
      if (shines(light)) lights.push_back(&light);
    Bounds3 bounds;
    for (const Instance& instance : scene.instances) {
      if (instance.mask == 0 || !isFinite(instance.worldFromObject)) continue;
      std::vector<Surface>& ofMesh = surfaces[static_cast<std::size_t>(instance.mesh)];
      const Mesh& mesh = scene.meshes[static_cast<std::size_t>(instance.mesh)];
      if (ofMesh.empty())
        for (const Geometry& geometry : mesh.geometries) ofMesh.push_back(surfaceOf(scene, geometry));
      const glm::dmat4 worldFromObject(instance.worldFromObject);
      const double determinant = std::abs(glm::determinant(glm::dmat3(worldFromObject)));
      if (!(determinant > 0.0)) continue;
      for (const Surface& surface : ofMesh) {
        if (!(surface.area() > 0.0)) continue;
        parts.push_back(
            {&surface, worldFromObject, glm::inverse(worldFromObject), std::cbrt(determinant * determinant)});
        for (const Bounds3& box : surface.boxes) bounds.extend(box.transformed(instance.worldFromObject));
      }
    }
    if (!bounds.empty()) size = glm::length(glm::dvec3(bounds.max) - glm::dvec3(bounds.min));
  }
  double boxCount() const {
    double count = 0.0;
    for (const Part& part : parts) count += 1.0 + static_cast<double>(part.surface->boxes.size());
    return count;
  }
  bool isBlocked(const glm::dvec3& from, const glm::dvec3& to) const {
    return std::ranges::any_of(parts, [&](const Part& part) { return blocks(part, from, to); });
  }
};

// The cosine at a point, on the side that counts, of the direction to another one.
double cosineAt(const Point& point, std::size_t receiver, const glm::dvec3& to) {
  const double side = point.part->surface->doubleSided && receiver % 2 == 1 ? -1.0 : 1.0;
  return side * glm::dot(point.normal, glm::normalize(to - point.position));
}

// The irradiance by emissive triangles.
double emittedLight(const World& world, const Distribution& emitters, std::size_t receiver, const Point& point) {
  const double jitter = quasirandom(receiver).y;
  double irradiance = 0.0;
  for (std::size_t e = 0; e < kEmitters && emitters.total() > 0.0; ++e) {
    const std::size_t index = receiver * kEmitters + e;
    const Point light = emitters.at((static_cast<double>(e) + jitter) / kEmitters, index);
    const glm::dvec3 to = light.position - point.position;
    const double square = glm::dot(to, to);
    if (!(square > 0.0)) continue;
    const double cosines =
        cosineAt(point, receiver, light.position) * std::abs(glm::dot(light.normal, to)) / std::sqrt(square);
    if (!(cosines > 0.0) || world.isBlocked(point.position, light.position)) continue;
    irradiance += emitters.total() / kEmitters * cosines / square;
  }
  return irradiance;
}

// The irradiance by the kEmitters punctual lights whose light is the strongest here without shadows.
double punctualLight(const World& world, std::size_t receiver, const Point& point) {
  std::vector<Arrival> arrivals;
  for (const Light* light : world.lights) {
    Arrival arrival = arrivalOf(*light, point.position, world.size);
    arrival.irradiance *= cosineAt(point, receiver, arrival.from);
    if (arrival.irradiance > 0.0) arrivals.push_back(arrival);
  }
  const auto tested = std::min(arrivals.size(), kEmitters);
  std::ranges::partial_sort(arrivals, arrivals.begin() + static_cast<std::ptrdiff_t>(tested), std::greater{},
                            &Arrival::irradiance);
  double irradiance = 0.0;
  for (const Arrival& arrival : std::span(arrivals).first(tested))
    if (!world.isBlocked(point.position, arrival.from)) irradiance += arrival.irradiance;
  return irradiance;
}

// Whether the emission of a part, or the light of others, makes the point lit.
bool isLit(const World& world, const Distribution& emitters, std::size_t receiver, const Point& point) {
  const Surface& surface = *point.part->surface;
  if (surface.emission >= kLitRadiance) return true;
  double reflected = emittedLight(world, emitters, receiver, point);
  if (surface.reflectance > 0.0f) reflected += double{surface.reflectance} * punctualLight(world, receiver, point);
  return reflected / glm::pi<double>() >= double{kLitRadiance};
}

// Whether any visible instance emits, and whether solids do.
struct Emission {
  bool any = false;
  bool solids = false;
};

Emission emissionOf(const Scene& scene) {
  Emission result;
  for (const Instance& instance : scene.instances) {
    if (instance.mask == 0) continue;
    const Mesh& mesh = scene.meshes[static_cast<std::size_t>(instance.mesh)];
    for (const Geometry& geometry : mesh.geometries)
      result.any = result.any || emission(scene, geometry.material) > 0.0f;
    for (const PrimitiveSet& set : mesh.primitiveSets)
      result.solids =
          result.solids || emission(scene, set.material) > 0.0f ||
          std::ranges::any_of(set.primitives, [&](const Primitive& p) { return emission(scene, p.material) > 0.0f; });
  }
  result.any = result.any || result.solids;
  return result;
}

}  // namespace

double litShare(const Scene& scene) {
  const auto emits = [&](const Geometry& g) { return emissionWithoutTexture(scene, g.material) > 0.0f; };
  const auto hasEmitters = [&](const Mesh& mesh) { return std::ranges::any_of(mesh.geometries, emits); };
  if (std::ranges::none_of(scene.lights, shines) && std::ranges::none_of(scene.meshes, hasEmitters)) return 0.0;
  const World world(scene);
  const Distribution emitters(world.parts, [](const Surface& s) { return static_cast<double>(s.emission); });
  const Distribution receivers(world.parts, [](const Surface&) { return 1.0; });
  if (!(emitters.total() > 0.0) && world.lights.empty()) return 0.0;
  if (!(receivers.total() > 0.0) || !std::isfinite(emitters.total()) || !std::isfinite(receivers.total())) return 0.0;
  const double affordable = kMaxBoxTests / (kEmitters * world.boxCount());
  const auto count = static_cast<std::size_t>(std::clamp(affordable, 16.0, static_cast<double>(kReceivers)));
  std::atomic<std::size_t> lit{0};
  parallelFor(count, [&](std::size_t i) {
    const Point point = receivers.at((static_cast<double>(i) + 0.5) / static_cast<double>(count), i);
    if (isLit(world, emitters, i, point)) ++lit;
  });
  return static_cast<double>(lit) / static_cast<double>(count);
}

OwnLight ownLight(const Scene& scene) {
  const Emission emission = emissionOf(scene);
  const bool punctual = std::ranges::any_of(scene.lights, shines);
  if (!punctual && !emission.any) return OwnLight::none;
  // Without an estimate: where no surfaces are; where solids are, since an author has placed the lights by hand; and animated lights,
  // which can be anywhere.
  const auto hasSolids = [](const Mesh& mesh) { return mesh.procedural(); };
  const auto isAnimated = [](const Light& light) { return shines(light) && light.animated(); };
  if (punctual && (scene.instances.empty() || std::ranges::any_of(scene.meshes, hasSolids) ||
                   std::ranges::any_of(scene.lights, isAnimated)))
    return OwnLight::punctual;
  if (emission.solids) return OwnLight::emission;
  const double share = litShare(scene);
  if (punctual) return share >= kPunctualShare ? OwnLight::punctual : OwnLight::faint;
  return share >= kLitShare ? OwnLight::emission : OwnLight::faint;
}

}  // namespace quintet::scene
