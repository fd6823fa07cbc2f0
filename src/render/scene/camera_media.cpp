// SPDX-License-Identifier: Apache-2.0
#include "render/scene/camera_media.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "scene/geometry/containment.h"
#include "scene/model/surface_class.h"

namespace quintet::render {
namespace {

using glm::dmat4;
using glm::dvec3;

// No ray can leave or enter a solid whose surface is invisible.
bool isVisibleMedium(const scene::Material& material) {
  return scene::isMedium(material) && !scene::isInvisible(material);
}

Bounds3 boundsOf(std::span<const vec3> positions) {
  Bounds3 bounds;
  for (const vec3& p : positions) bounds.extend(p);
  return bounds;
}

bool isInside(const Bounds3& bounds, const dvec3& p) {
  return glm::all(glm::greaterThanEqual(p, dvec3(bounds.min))) && glm::all(glm::lessThanEqual(p, dvec3(bounds.max)));
}

double volumeOf(const Bounds3& bounds) {
  const dvec3 extent(bounds.extent());
  return extent.x * extent.y * extent.z;
}

}  // namespace

CameraMedia::CameraMedia(const scene::Scene& scene, Fetch fetch) : fetch_(std::move(fetch)) {
  for (const scene::Material& material : scene.materials) isMedium_.push_back(isVisibleMedium(material));
  for (const scene::Mesh& mesh : scene.meshes) {
    Mesh& copy = meshes_.emplace_back();
    copy.deformed = mesh.deformation != nullptr;
    copy.sets = mesh.primitiveSets;
    std::erase_if(copy.sets, [](const auto& set) { return set.kind == scene::PrimitiveSetKind::custom; });
    for (const scene::Geometry& geometry : mesh.geometries) {
      Part& part = copy.parts.emplace_back();
      part.material = geometry.material == scene::kNone ? isMedium_.size() : std::size_t(geometry.material);
      if (part.material < isMedium_.size() && isMedium_[part.material] && !copy.deformed)
        part.bounds = boundsOf(geometry.positions);
    }
  }
  isMedium_.push_back(false);  // the default material
  for (const scene::Instance& instance : scene.instances)
    meshOfInstance_.push_back(instance.mask != 0 ? instance.mesh : scene::kNone);
}

void CameraMedia::setMaterial(std::size_t index, const scene::Material& material) {
  isMedium_[index] = isVisibleMedium(material);
}

void CameraMedia::deform() {
  for (Mesh& mesh : meshes_) {
    if (!mesh.deformed) continue;
    for (Part& part : mesh.parts) {
      part.bounds.reset();
      part.arrays.reset();
    }
  }
}

bool CameraMedia::any() const { return std::ranges::find(isMedium_, true) != isMedium_.end(); }

void CameraMedia::findInMesh(std::size_t mesh, const dvec3& point, double scale, std::vector<Found>& found) {
  std::vector<Part>& parts = meshes_[mesh].parts;
  const auto arraysOf = [&](std::size_t part) -> const MeshArrays& {
    if (!parts[part].arrays) parts[part].arrays = fetch_(mesh, part);
    return *parts[part].arrays;
  };
  std::vector<bool> done(isMedium_.size(), false);
  for (std::size_t first = 0; first < parts.size(); ++first) {
    // All geometries of the mesh with this material bound one solid.
    const std::size_t material = parts[first].material;
    if (!isMedium_[material] || done[material]) continue;
    done[material] = true;
    Bounds3 bounds;
    for (std::size_t i = first; i < parts.size(); ++i) {
      if (parts[i].material != material) continue;
      if (!parts[i].bounds) parts[i].bounds = boundsOf(arraysOf(i).positions);
      bounds.extend(*parts[i].bounds);
    }
    if (!isInside(bounds, point)) continue;
    double winding = 0.0;
    for (std::size_t i = first; i < parts.size(); ++i)
      if (parts[i].material == material)
        winding += scene::windingNumber(arraysOf(i).positions, arraysOf(i).triangles, point);
    // Rays leave a solid as often as they have entered it, so parts of a mesh that overlap count separately.
    for (double count = 0.5; count < winding && count < double{shared::kMaxMedia}; count += 1.0)
      found.push_back({scale * volumeOf(bounds), static_cast<std::uint32_t>(material) + 1});
  }
}

void CameraMedia::findInSets(const Mesh& mesh, const dvec3& point, double scale, std::vector<Found>& found) const {
  const auto isMedium = [&](const scene::Primitive& p) {
    return p.material != scene::kNone && isMedium_[std::size_t(p.material)];
  };
  const auto add = [&](const scene::Primitive& p, const Bounds3& bounds) {
    found.push_back({scale * volumeOf(bounds), static_cast<std::uint32_t>(p.material) + 1});
  };
  for (const scene::PrimitiveSet& set : mesh.sets) {
    if (set.kind == scene::PrimitiveSetKind::solids) {
      for (const scene::Primitive& p : set.primitives)
        if (isMedium(p) && scene::contains(p, point)) add(p, scene::boundsOf(p));
      continue;
    }
    for (const scene::CsgTree& tree : set.trees) {
      if (!scene::contains(set, tree, point)) continue;
      // A path that enters the tree is in the solid whose surface it passes. Here, the first solid around the point
      // stands for it.
      for (std::uint32_t i = 0; i < tree.nodeCount; ++i) {
        const scene::CsgNode& node = set.nodes[tree.firstNode + i];
        if (node.operation != scene::CsgOperation::leaf) continue;
        const scene::Primitive& p = set.primitives[node.primitive];
        if (!isMedium(p) || !scene::contains(p, point)) continue;
        add(p, scene::boundsOf(set, tree));
        break;
      }
    }
  }
}

Media CameraMedia::at(const vec3& point, std::span<const mat4> worldFromObject) {
  Media media{};
  if (!any()) return media;
  std::vector<Found> found;
  for (std::size_t i = 0; i < meshOfInstance_.size(); ++i) {
    if (meshOfInstance_[i] == scene::kNone) continue;
    const dmat4 world(worldFromObject[i]);
    const double scale = std::abs(glm::determinant(world));
    if (!(scale > 0.0)) continue;
    const dvec3 object(glm::inverse(world) * glm::dvec4(point, 1.0));
    const auto mesh = static_cast<std::size_t>(meshOfInstance_[i]);
    findInMesh(mesh, object, scale, found);
    findInSets(meshes_[mesh], object, scale, found);
  }
  // The smallest solid is the innermost one.
  std::ranges::stable_sort(found, {}, &Found::volume);
  for (std::size_t i = 0; i < std::min(found.size(), media.size()); ++i) media[i] = found[i].medium;
  return media;
}

}  // namespace quintet::render
