// SPDX-License-Identifier: Apache-2.0
// Finds the solids around the camera, in which camera rays start (shaders/quintet/media.glsl). A point is in a mesh if its
// winding number is above 1/2, so that meshes with small holes work. Only meshes whose bounding box contains the camera
// are read back from the device, once.
#ifndef QUINTET_RENDER_SCENE_CAMERA_MEDIA_H
#define QUINTET_RENDER_SCENE_CAMERA_MEDIA_H

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "quintet/shared/frame.h"
#include "scene/model/scene.h"

namespace quintet::render {

// Triangles of a geometry in host memory.
struct MeshArrays {
  std::vector<vec3> positions;  // object space
  std::vector<uvec3> triangles;
};

// As Frame::cameraMedia.
using Media = std::array<std::uint32_t, shared::kMaxMedia>;

class CameraMedia {
 public:
  // Reads back a geometry of a mesh of the scene.
  using Fetch = std::function<MeshArrays(std::size_t mesh, std::size_t geometry)>;
  // Copies what it needs of the scene.
  CameraMedia(const scene::Scene& scene, Fetch fetch);

  // After an edit of a material.
  void setMaterial(std::size_t index, const scene::Material& material);
  // The vertices of the deformed meshes have changed.
  void deform();

  // True if a material is a medium. Without one, at() returns none.
  bool any() const;
  // Returns the solids around a point in world space. If there are more than kMaxMedia, the largest are missing.
  // `worldFromObject`: of the instances.
  Media at(const vec3& point, std::span<const mat4> worldFromObject);

 private:
  struct Part {  // a geometry
    std::size_t material;
    std::optional<Bounds3> bounds;     // object space; unknown until it is needed
    std::optional<MeshArrays> arrays;  // if it was needed
  };
  struct Mesh {
    std::vector<Part> parts;
    std::vector<scene::PrimitiveSet> sets;  // that have a material of their own
    bool deformed = false;
  };
  struct Found {
    double volume;  // of the bounding box in world space
    std::uint32_t medium;
  };

  void findInMesh(std::size_t mesh, const glm::dvec3& point, double scale, std::vector<Found>& found);
  void findInSets(const Mesh& mesh, const glm::dvec3& point, double scale, std::vector<Found>& found) const;

  Fetch fetch_;
  std::vector<bool> isMedium_;  // per material: a medium, and not invisible
  std::vector<Mesh> meshes_;
  std::vector<int> meshOfInstance_;  // scene::kNone for instances that rays cannot hit
};

}  // namespace quintet::render
#endif
