// SPDX-License-Identifier: Apache-2.0
// What linking and checking need to know about a scene: which geometry runs which shaders. It holds no vertices.
// check/scene_facts.h derives it from a scene::Scene; tests write it by hand.
#ifndef QUINTET_PROGRAM_SCENE_FACTS_H
#define QUINTET_PROGRAM_SCENE_FACTS_H

#include <cstdint>
#include <string>
#include <vector>

namespace quintet::program {

enum class GeometryKind { triangles, solids, csg, custom };

// One geometry of a BLAS. Its position in SceneFacts::geometries is its position in the hit records.
struct GeometryFacts {
  GeometryKind kind = GeometryKind::triangles;
  bool alpha = false;    // the material needs an alpha test
  std::string name;      // of the primitive set or mesh; can be empty
  std::string material;  // name; can be empty
  bool thin = false;     // the material has smooth thin walls, which shadow rays can pass
  bool tints = false;    // any-hit shaders multiply the transmittance (thin, blend): built with NO_DUPLICATE_ANY_HIT
  bool opaque() const { return !alpha && !thin; }  // built with the opaque flag: no any-hit shader runs
  bool procedural() const { return kind != GeometryKind::triangles; }
  bool operator==(const GeometryFacts&) const = default;
};

// One instance of the TLAS with the geometries of its BLAS.
struct InstanceFacts {
  std::string name;
  std::uint32_t firstGeometry = 0;  // index in SceneFacts::geometries
  std::uint32_t geometryCount = 1;
  std::uint32_t mask = 0xFF;
  bool forceOpaque = false;
  bool forceNoOpaque = false;
  std::uint32_t customIndex = 0;  // set by the user: scene::Instance::customIndex
  bool transformed = false;       // object space differs from world space, at least at some time
  bool operator==(const InstanceFacts&) const = default;
};

struct SceneFacts {
  std::string name;  // file, for messages
  std::vector<GeometryFacts> geometries;
  std::vector<InstanceFacts> instances;
  bool operator==(const SceneFacts&) const = default;
};

}  // namespace quintet::program
#endif
