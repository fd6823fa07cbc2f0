// SPDX-License-Identifier: Apache-2.0
// Where the scene of a job comes from: a file, memory, the program's own scene, or the built-in one.
#ifndef QUINTET_JOB_SCENE_SOURCE_H
#define QUINTET_JOB_SCENE_SOURCE_H

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "job/request.h"
#include "program/description/program.h"
#include "scene/defaults/default_scene.h"
#include "scene/load.h"

namespace quintet::job {

struct SceneSource {
  std::filesystem::path file;                  // empty if the scene is the program's own or built in
  scene::LoadOptions options;                  // of a file, and of `text`
  std::string name;                            // for messages and metadata; the path of the program's own scene
  std::string text;                            // TOML of the program's own scene; empty if there is none
  std::shared_ptr<const scene::Scene> loaded;  // in host memory; null if it has to be loaded
  scene::DefaultSceneOptions builtIn;          // the parts of the built-in scene that the program's hit groups serve
  bool operator==(const SceneSource&) const = default;

  std::string path() const { return file.empty() ? name : file.string(); }
};

// Returns whether the name is that of a scene file (scene::sceneFormat) rather than a program. program.toml is none.
bool isSceneFile(const std::filesystem::path& file);

// `requested` if it is not empty, else the scene that the program names, else the built-in one. Throws FileError if the
// file cannot be read, UsageError for a scene, a variant or a named animation of a glTF file without file.
SceneSource chooseSceneSource(const std::filesystem::path& requested, const program::Program& program,
                              const scene::LoadOptions& options = {});

// How the scene of a request is loaded: variant and animation. `accumulates`: the program counts its frames itself.
scene::LoadOptions loadOptions(const RenderRequest& request, bool accumulates);

// The first step of loading: everything but the image data of a glTF file. Throws FileError, MemoryError.
scene::PendingScene beginLoading(const SceneSource& source);
scene::Scene loadScene(const SceneSource& source);

// The file on disk, if there is one, for file watching.
std::vector<std::filesystem::path> sourceFiles(const SceneSource& source);

}  // namespace quintet::job
#endif
