#include "render/light_table.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <optional>

#include "base/parallel.h"
#include "render/alias_table.h"
#include "render/emission_map.h"
#include "render/luminance.h"
#include "render/solid_area.h"

namespace quintet::render {
namespace {

constexpr double kPiDouble = glm::pi<double>();
constexpr std::size_t kTrianglesPerTask = 4096;

// The classes that share the samples (kMinimumClassShare).
enum class LightClass { local, directional, surfaces, environment };

template <class Body>
void forTriangles(std::size_t count, const Body& body) {
  parallelFor((count + kTrianglesPerTask - 1) / kTrianglesPerTask, [&](std::size_t task) {
    const std::size_t end = std::min(count, (task + 1) * kTrianglesPerTask);
    for (std::size_t i = task * kTrianglesPerTask; i < end; ++i) body(i);
  });
}

double worldArea(const scene::Geometry& geometry, const uvec3& t, const glm::dmat3& worldFromObject) {
  const glm::dvec3 p0 = geometry.positions[t.x];
  const glm::dvec3 edge1 = worldFromObject * (glm::dvec3(geometry.positions[t.y]) - p0);
  const glm::dvec3 edge2 = worldFromObject * (glm::dvec3(geometry.positions[t.z]) - p0);
  const double area = 0.5 * glm::length(glm::cross(edge1, edge2));
  return std::isfinite(area) ? area : 0.0;
}

// An emissive geometry of a mesh: mean luminance of each triangle or solid, the same for all instances.
struct Emitter {
  std::vector<float> luminance;
  bool black = true;
};

Emitter makeEmitter(const scene::Geometry& geometry, const EmissionMap& map) {
  Emitter emitter;
  emitter.luminance.resize(geometry.triangles.size());
  const std::vector<vec2>& uvs = geometry.uvs[static_cast<std::size_t>(map.uvSet())];
  forTriangles(geometry.triangles.size(), [&](std::size_t i) {
    const uvec3 t = geometry.triangles[i];
    const auto uv = [&](std::uint32_t vertex) { return uvs.empty() ? vec2(0.0f) : uvs[vertex]; };
    emitter.luminance[i] = map.meanOver(uv(t.x), uv(t.y), uv(t.z));
  });
  emitter.black = std::ranges::all_of(emitter.luminance, [](float l) { return l <= 0.0f; });
  return emitter;
}

bool uses(const scene::PrimitiveSet& set, int material) {
  return std::ranges::find(set.primitives, material, &scene::Primitive::material) != set.primitives.end();
}

// The solids of one material; those of others keep what they have.
void addSolids(Emitter& emitter, const scene::PrimitiveSet& set, int material, const EmissionMap& map) {
  emitter.luminance.resize(set.primitives.size(), 0.0f);
  const float mean = 0.5f * (map.meanOver({0, 0}, {1, 0}, {1, 1}) + map.meanOver({0, 0}, {1, 1}, {0, 1}));
  for (std::size_t i = 0; i < set.primitives.size(); ++i)
    if (set.primitives[i].material == material) emitter.luminance[i] = mean;
  emitter.black = emitter.black && mean <= 0.0f;
}

class Builder {
 public:
  Builder(const scene::Scene& scene, const scene::Environment& environment, std::size_t maxTriangleLights)
      : scene_(scene) {
    const Bounds3 bounds = scene::worldBounds(scene);
    const double radius = bounds.empty() ? 0.0 : 0.5 * glm::length(glm::dvec3(bounds.max) - glm::dvec3(bounds.min));
    crossSection_ = kPiDouble * (radius > 0.0 && std::isfinite(radius) ? radius * radius : 1.0);
    for (const scene::Light& light : scene.lights) addPunctual(light);
    addTriangles(maxTriangleLights);
    table_.environment = buildEnvironmentTable(environment);
    if (table_.environment.width > 0) {
      table_.environmentLight = static_cast<std::uint32_t>(table_.lights.size());
      shared::LightData light{};
      light.type = shared::kLightEnvironment;
      add(light, table_.environment.integral * crossSection_);
    }
  }

  LightTable run() {
    table_.entries = buildAliasTable(weights());
    if (table_.entries.empty()) {
      table_.lights.clear();
      std::ranges::fill(table_.slots, shared::kNoLight);
      table_.environmentLight = shared::kNoLight;
    }
    return std::move(table_);
  }

 private:
  void add(const shared::LightData& light, double power) {
    table_.lights.push_back(light);
    powers_.push_back(power);
  }

  void addPunctual(const scene::Light& light) {
    shared::LightData data{};
    data.intensity = light.intensity;
    data.position = light.position;
    data.direction = light.direction;
    data.cosInner = std::cos(light.innerConeAngle);
    data.cosOuter = std::cos(light.outerConeAngle);
    const double luminance = lightLuminance(light.intensity);
    switch (light.type) {
      case scene::LightType::point:
        data.type = shared::kLightPoint;
        return add(data, 4.0 * kPiDouble * luminance);
      case scene::LightType::spot:
        data.type = shared::kLightSpot;
        return add(data, luminance * spotSolidAngle(data.cosInner, data.cosOuter));
      case scene::LightType::directional:
        data.type = shared::kLightDirectional;
        return add(data, luminance * crossSection_);
    }
  }

  // Means of all emissive geometries, by mesh and geometry; one map of a material at a time.
  std::vector<std::vector<Emitter>> makeEmitters() const {
    std::vector<std::vector<Emitter>> emitters(scene_.meshes.size());
    for (std::size_t m = 0; m < scene_.materials.size(); ++m) {
      const scene::Material& material = scene_.materials[m];
      if (material.unlit || lightLuminance(material.emissive) <= 0.0f) continue;
      std::optional<EmissionMap> map;
      for (std::size_t i = 0; i < scene_.meshes.size(); ++i) {
        const std::vector<scene::PrimitiveSet>& sets = scene_.meshes[i].primitiveSets;
        for (std::size_t g = 0; g < sets.size(); ++g) {
          if (sets[g].kind != scene::PrimitiveSetKind::solids || !uses(sets[g], static_cast<int>(m))) continue;
          if (!map) map.emplace(scene_, material);
          emitters[i].resize(sets.size());
          addSolids(emitters[i][g], sets[g], static_cast<int>(m), *map);
        }
        const std::vector<scene::Geometry>& geometries = scene_.meshes[i].geometries;
        for (std::size_t g = 0; g < geometries.size(); ++g) {
          if (geometries[g].material != static_cast<int>(m)) continue;
          if (!map) map.emplace(scene_, material);
          emitters[i].resize(geometries.size());
          if (!map->black()) emitters[i][g] = makeEmitter(geometries[g], *map);
        }
      }
    }
    return emitters;
  }

  struct Part {
    std::size_t instance;
    std::size_t geometry;
    std::size_t slot;
    const Emitter* emitter;
  };

  void addTriangles(std::size_t maxCount) {
    const std::vector<std::vector<Emitter>> emitters = makeEmitters();
    std::vector<Part> parts;
    for (std::size_t i = 0; i < scene_.instances.size(); ++i) {
      const int mesh = scene_.instances[i].mesh;
      table_.firstSlots.push_back(static_cast<std::uint32_t>(table_.slots.size()));
      if (mesh == scene::kNone) continue;
      for (std::size_t g = 0; g < scene_.meshes[mesh].geometryCount(); ++g) {
        if (g < emitters[mesh].size() && !emitters[mesh][g].black)
          parts.push_back({i, g, table_.slots.size(), &emitters[mesh][g]});
        table_.slots.push_back(shared::kNoLight);
      }
    }
    dropLargest(parts, maxCount);
    for (const Part& part : parts) addPart(part);
  }

  static void dropLargest(std::vector<Part>& parts, std::size_t maxCount) {
    const auto triangles = [](const Part& p) { return p.emitter->luminance.size(); };
    std::size_t total = 0;
    for (const Part& part : parts) total += triangles(part);
    if (total <= maxCount) return;
    std::ranges::stable_sort(parts, {}, triangles);
    std::size_t kept = 0;
    total = 0;
    while (total + triangles(parts[kept]) <= maxCount) total += triangles(parts[kept++]);
    parts.resize(kept);
  }

  void addPart(const Part& part) {
    const scene::Instance& instance = scene_.instances[part.instance];
    const scene::Mesh& mesh = scene_.meshes[instance.mesh];
    const glm::dmat3 linear{glm::mat3(instance.worldFromObject)};
    const std::size_t first = table_.lights.size(), count = part.emitter->luminance.size();
    table_.slots[part.slot] = static_cast<std::uint32_t>(first);
    shared::LightData light{};
    light.type = mesh.procedural() ? shared::kLightSolid : shared::kLightTriangle;
    light.instance = static_cast<shared::uint>(part.instance);
    light.geometry = static_cast<shared::uint>(part.geometry);
    table_.lights.resize(first + count, light);
    powers_.resize(table_.lights.size());
    const auto area = [&](std::size_t i) {
      if (mesh.procedural()) return solidArea(mesh.primitiveSets[part.geometry].primitives[i], linear);
      const scene::Geometry& geometry = mesh.geometries[part.geometry];
      return worldArea(geometry, geometry.triangles[i], linear);
    };
    forTriangles(count, [&](std::size_t i) {
      table_.lights[first + i].primitive = static_cast<shared::uint>(i);
      const float luminance = part.emitter->luminance[i];
      powers_[first + i] = luminance > 0.0f ? kPiDouble * area(i) * luminance : 0.0;
    });
  }

  static LightClass classOf(const shared::LightData& light) {
    switch (light.type) {
      case shared::kLightDirectional: return LightClass::directional;
      case shared::kLightTriangle:
      case shared::kLightSolid: return LightClass::surfaces;
      case shared::kLightEnvironment: return LightClass::environment;
      default: return LightClass::local;
    }
  }

  // Powers scaled so that each class gets its share.
  std::vector<float> weights() const {
    std::array<double, 4> sums{};
    for (std::size_t i = 0; i < powers_.size(); ++i)
      sums[static_cast<std::size_t>(classOf(table_.lights[i]))] += std::isfinite(powers_[i]) ? powers_[i] : 0.0;
    const double total = std::accumulate(sums.begin(), sums.end(), 0.0);
    const auto present = static_cast<double>(std::ranges::count_if(sums, [](double s) { return s > 0.0; }));
    std::array<double, 4> factors{};
    for (std::size_t c = 0; c < sums.size(); ++c)
      if (sums[c] > 0.0)
        factors[c] = (kMinimumClassShare + (1.0 - kMinimumClassShare * present) * (sums[c] / total)) / sums[c];
    std::vector<float> result(powers_.size());
    for (std::size_t i = 0; i < powers_.size(); ++i)
      result[i] = static_cast<float>(powers_[i] * factors[static_cast<std::size_t>(classOf(table_.lights[i]))]);
    return result;
  }

  const scene::Scene& scene_;
  double crossSection_ = 0.0;  // π·R², m²
  LightTable table_;
  std::vector<double> powers_;  // one per light
};

}  // namespace

double spotSolidAngle(double cosInner, double cosOuter) {
  // a = ((c - cosOuter) / width)² until it reaches 1 (or c does), then 1; ∫ 2π a dc.
  const double width = std::max(0.001, cosInner - cosOuter);
  const double ramp = std::min(width, 1.0 - cosOuter);
  return 2.0 * kPiDouble * (ramp * ramp * ramp / (3.0 * width * width) + (1.0 - cosOuter - ramp));
}

LightTable buildLightTable(const scene::Scene& scene, const scene::Environment& environmentInUse,
                           std::size_t maxTriangleLights) {
  return Builder(scene, environmentInUse, maxTriangleLights).run();
}

}  // namespace quintet::render
