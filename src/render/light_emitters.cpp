#include "render/light_emitters.h"

#include <optional>

#include "render/emission_map.h"
#include "render/luminance.h"
#include "render/solid_area.h"

namespace quintet::render {
namespace {

// The triangles of a geometry, all of one material.
void addTriangles(Emitter& emitter, const scene::Geometry& geometry, const EmissionMap& map) {
  emitter.triangles = &geometry;
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

// The solids of one material; those of others keep what they have.
void addSolids(Emitter& emitter, const scene::PrimitiveSet& set, int material, const EmissionMap& map) {
  emitter.solids = &set;
  emitter.luminance.resize(set.primitives.size(), 0.0f);
  const float mean = 0.5f * (map.meanOver({0, 0}, {1, 0}, {1, 1}) + map.meanOver({0, 0}, {1, 1}, {0, 1}));
  for (std::size_t i = 0; i < set.primitives.size(); ++i)
    if (set.primitives[i].material == material) emitter.luminance[i] = mean;
  emitter.black = emitter.black && mean <= 0.0f;
}

}  // namespace

void Emitter::keep() {
  if (triangles && !ownTriangles) {
    scene::Geometry copy;
    copy.positions = triangles->positions;
    copy.triangles = triangles->triangles;
    ownTriangles = std::make_shared<scene::Geometry>(std::move(copy));
    triangles = ownTriangles.get();
  }
  if (solids && !ownSolids) {
    ownSolids = std::make_shared<scene::PrimitiveSet>(*solids);
    solids = ownSolids.get();
  }
}

std::vector<std::vector<Emitter>> makeEmitters(const scene::Scene& scene) {
  std::vector<std::vector<Emitter>> emitters(scene.meshes.size());
  for (std::size_t m = 0; m < scene.materials.size(); ++m) {  // one map of a material at a time
    const scene::Material& material = scene.materials[m];
    if (material.unlit || lightLuminance(material.emissive) <= 0.0f) continue;
    std::optional<EmissionMap> map;
    for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
      const std::vector<scene::PrimitiveSet>& sets = scene.meshes[i].primitiveSets;
      for (std::size_t g = 0; g < sets.size(); ++g) {
        if (sets[g].kind != scene::PrimitiveSetKind::solids || !uses(sets[g], static_cast<int>(m))) continue;
        if (!map) map.emplace(scene, material);
        emitters[i].resize(sets.size());
        addSolids(emitters[i][g], sets[g], static_cast<int>(m), *map);
      }
      const std::vector<scene::Geometry>& geometries = scene.meshes[i].geometries;
      for (std::size_t g = 0; g < geometries.size(); ++g) {
        if (geometries[g].material != static_cast<int>(m)) continue;
        if (!map) map.emplace(scene, material);
        emitters[i].resize(geometries.size());
        addTriangles(emitters[i][g], geometries[g], *map);
      }
    }
  }
  return emitters;
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
  // A body of any shape is seen, on the average over all directions, as a quarter of its area (Cauchy 1841; convex).
  if (emitter.solids) return solidBounds(emitter.solids->primitives[i], worldFromObject, 0.25 * area);
  const uvec3& t = emitter.triangles->triangles[i];
  const std::vector<vec3>& p = emitter.triangles->positions;
  return triangleBounds({p[t.x], p[t.y], p[t.z]}, worldFromObject, area);
}

}  // namespace quintet::render
