// SPDX-License-Identifier: Apache-2.0
// State that the readers of a scene file share: the scene so far, and the objects behind its names.
#ifndef QUINTET_SCENE_TOML_CONTEXT_H
#define QUINTET_SCENE_TOML_CONTEXT_H

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "base/memory_budget.h"
#include "base/toml_reader.h"
#include "io/image.h"
#include "scene/load_options.h"
#include "scene/model/scene.h"

namespace quintet::scene {

// The target of an [[instance]]: one mesh, or the instances of a glTF file.
struct InstanceTarget {
  std::vector<Instance> instances;  // relative to the target's own origin
  std::vector<Light> lights;        // of a glTF file, relative to its origin
  std::vector<Camera> cameras;
  int line = 0;
  bool placed = false;          // by an [[instance]]
  bool placedByDefault = true;  // once at the origin, unless an [[instance]] places it
};

// A CSG tree that other trees can use: the only one of its set. Its solids do not yet have the default material.
struct NamedTree {
  PrimitiveSet set;
  std::string target;  // key in SceneTomlContext::targets; empty if the tree is part of an object
};

struct SceneTomlContext {
  SceneTomlContext(const std::filesystem::path& sceneFile, const LoadOptions& loadOptions)
      : file(sceneFile),
        folder(sceneFile.parent_path()),
        options(loadOptions),
        sharedBudget(std::make_shared<MemoryBudget>(sceneFile, loadOptions.maxMemory)),
        budget(*sharedBudget) {
    animation.framesPerSecond = loadOptions.framesPerSecond;
  }

  const std::filesystem::path file;
  const std::filesystem::path folder;  // paths in the file are relative to it
  const LoadOptions options;
  const std::shared_ptr<MemoryBudget> sharedBudget;  // also of the glTF files
  MemoryBudget& budget;
  Scene scene;
  NodeAnimation animation;                        // of the glTF files and keyframes; of the scene if it has samplers
  std::map<std::string, int> materials;           // "name" or "file/name"
  std::map<std::string, InstanceTarget> targets;  // "name" or "file/mesh"
  std::map<std::string, NamedTree> trees;

  [[noreturn]] void fail(const TomlValue& at, std::string_view problem) const { failAt(file, at, problem); }

  // Checks that the name of an object is not empty and has no '/'.
  void checkName(const TomlValue& at, const std::string& name) const;
  // Path of an existing file, relative to the scene file.
  std::filesystem::path resolvePath(const TomlValue& at, const std::string& path) const;
  // Reads an image within the memory budget, and adds the file to those of the scene. Throws FileError, MemoryError.
  io::Image readImage(const std::filesystem::path& file);
  io::Image readRadiance(const std::filesystem::path& file);  // as linear floats
  // Index of a material. Reports an unknown name.
  int findMaterial(const TomlValue& name) const;
  // Index of the default material (matte, gray), which is added to the scene when it is first used.
  int defaultMaterial();
  // Gives the default material to the solids that have none.
  void applyDefaultMaterial(PrimitiveSet&);
  // Reads material = "name"; kNone if the key is absent.
  int readMaterialKey(TomlReader& reader) const;
  // Index of the mesh for a table: that of the key `object`, which several tables can share, else a new mesh called
  // `name`.
  int meshFor(TomlReader& reader, const std::string& name, bool procedural);
  // Reports a name that is already used.
  void addTarget(const TomlValue& at, const std::string& name, InstanceTarget target);

 private:
  // Repairs the values of an image that was read, and adds it to the report.
  void addImageFile(const std::filesystem::path& file, io::Image&);

  int defaultMaterial_ = kNone;
  std::map<std::string, int> objects_;
};

// "[[spheres]] 'name'", or "[[spheres]]" without a name.
std::string describeTable(const std::string& key, const TomlValue& table);

// Linear RGB from three linear numbers, or from "#rrggbb", which is decoded from sRGB.
vec3 toColor(const TomlReader& reader, const TomlValue& value, std::string_view name, const NumberRange& range);
// Reads a key as a color; `fallback` if it is absent.
vec3 readColor(TomlReader& reader, const std::string& key, const vec3& fallback, const NumberRange& range);

// Readers of the parts, in the order in which they are called. Each is in the file of its name.
void readFiles(SceneTomlContext&, TomlReader& root);        // [[file]]
void readMaterials(SceneTomlContext&, TomlReader& root);    // [[material]]
void readMeshes(SceneTomlContext&, TomlReader& root);       // [[mesh]]
void readPrimitives(SceneTomlContext&, TomlReader& root);   // [[spheres]] … [[tori]], [[csg]], [[custom]]
void readInstances(SceneTomlContext&, TomlReader& root);    // [[instance]], and objects without one
void readLights(SceneTomlContext&, TomlReader& root);       // [[light]]
void readCameras(SceneTomlContext&, TomlReader& root);      // [[camera]]
void readEnvironment(SceneTomlContext&, TomlReader& root);  // [environment]

}  // namespace quintet::scene
#endif
