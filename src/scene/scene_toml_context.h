// What the parts of a scene file share while it is read: the scene so far, and what its names mean.
#ifndef QUINTET_SCENE_SCENE_TOML_CONTEXT_H
#define QUINTET_SCENE_SCENE_TOML_CONTEXT_H

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "scene/memory_budget.h"
#include "scene/scene.h"
#include "scene/scene_toml_reader.h"

namespace quintet::scene {

// What an [[instance]] can be of: one mesh, or the instances of a glTF file.
struct InstanceTarget {
  std::vector<Instance> instances;  // relative to the target's own origin
  std::vector<Light> lights;        // of a file, likewise
  std::vector<Camera> cameras;
  unsigned line = 0;
  bool placed = false;      // by an [[instance]]
  bool placedAlone = true;  // once at the origin if no [[instance]] does so
};

// A CSG tree that others can use: the only one of its set, before solids without a material got the default.
struct NamedTree {
  PrimitiveSet set;
  std::string target;  // SceneTomlContext::targets; empty: part of an object
};

struct SceneTomlContext {
  SceneTomlContext(const std::filesystem::path& sceneFile, std::size_t memoryLimit)
      : file(sceneFile), folder(sceneFile.parent_path()), budget(sceneFile, memoryLimit) {}

  const std::filesystem::path file;
  const std::filesystem::path folder;  // paths in the file are relative to it
  MemoryBudget budget;
  Scene scene;
  std::map<std::string, int> materials;           // "name" or "file/name"
  std::map<std::string, InstanceTarget> targets;  // "name" or "file/mesh"
  std::map<std::string, NamedTree> trees;

  [[noreturn]] void fail(const TomlValue& at, std::string_view problem) const { failAt(file, at, problem); }

  // The [[key]] tables of the file; refuses what is written otherwise.
  const std::vector<TomlValue>& tables(TomlReader& root, const std::string& key) const;
  // Checks a name that something is given: no '/', not empty.
  void checkName(const TomlValue& at, const std::string& name) const;
  // An existing file beside the scene.
  std::filesystem::path resolve(const TomlValue& at, const std::string& path) const;
  int findMaterial(const TomlValue& name) const;
  // For what names none: matte, grey. Added when first needed.
  int defaultMaterial();
  // Gives the default material to the solids that have none.
  void fillMaterials(PrimitiveSet&);
  // material = "name"; kNone if the key is absent.
  int readMaterialKey(TomlReader& reader) const;
  // The mesh that `object` names, new or (for several geometries in one acceleration structure) known already; `name`
  // if there is no `object`.
  int meshFor(TomlReader& reader, const std::string& name, bool procedural);
  void addTarget(const TomlValue& at, const std::string& name, InstanceTarget target);

 private:
  int defaultMaterial_ = kNone;
  std::map<std::string, int> objects_;
};

// "[[spheres]] 'name'", or without the name where there is none.
std::string describeTable(const std::string& key, const TomlValue& table);

// The parts, in the order in which they are read.
void readFiles(SceneTomlContext&, TomlReader& root);          // scene_toml_files.cpp
void readMaterials(SceneTomlContext&, TomlReader& root);      // scene_toml_material.cpp
void readMeshes(SceneTomlContext&, TomlReader& root);         // scene_toml_mesh.cpp
void readPrimitiveSets(SceneTomlContext&, TomlReader& root);  // scene_toml_primitives.cpp
void readCsg(SceneTomlContext&, const TomlValue& table);      // scene_toml_csg.cpp, called by the former
void readInstances(SceneTomlContext&, TomlReader& root);      // scene_toml_instances.cpp
void readView(SceneTomlContext&, TomlReader& root);           // scene_toml_view.cpp: lights, cameras, environment

}  // namespace quintet::scene
#endif
