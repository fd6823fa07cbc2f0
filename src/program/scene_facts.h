// What the link needs to know of a scene: no geometry, only what decides which shader runs. Made by
// render::sceneFacts from a scene::Scene; a test writes it by hand.
#ifndef QUINTET_PROGRAM_SCENE_FACTS_H
#define QUINTET_PROGRAM_SCENE_FACTS_H

#include <cstdint>
#include <string>
#include <vector>

namespace quintet::program {

enum class GeometryKind { triangles, solids, csg, custom };

// One geometry of a BLAS; its position in SceneFacts::geometries is its position in the hit records.
struct GeometryFacts {
  GeometryKind kind = GeometryKind::triangles;
  bool alpha = false;    // its material needs an alpha test
  std::string name;      // of the primitive set or mesh; may be empty
  std::string material;  // name; may be empty
  bool thin = false;     // its material has smooth thin walls, which shadow rays may pass
  bool tints = false;    // any-hit shaders multiply what it leaves of light (thin, blend): built to be asked once
  bool opaque() const { return !alpha && !thin; }  // built with the opaque flag: no any-hit shader runs
  bool procedural() const { return kind != GeometryKind::triangles; }
};

// One instance of the top level, with the geometries of its BLAS.
struct InstanceFacts {
  std::string name;
  std::uint32_t firstGeometry = 0;  // in SceneFacts::geometries
  std::uint32_t geometryCount = 1;
  std::uint32_t mask = 0xFF;
  bool forceOpaque = false;
  bool forceNoOpaque = false;
};

struct Program;

struct SceneFacts {
  std::string name;  // for messages: the file
  std::vector<GeometryFacts> geometries;
  std::vector<InstanceFacts> instances;
};

// The scene as this program has it: with Program::anyHitForAll no instance is opaque unless it is forced to be.
SceneFacts factsFor(const Program& program, SceneFacts facts);

}  // namespace quintet::program
#endif
