// Where a program's scene comes from: the command line, the program, or the binary.
#ifndef QUINTET_APP_SCENE_SOURCE_H
#define QUINTET_APP_SCENE_SOURCE_H

#include <filesystem>
#include <string>
#include <vector>

#include "program/program.h"
#include "scene/default_scene.h"
#include "scene/load.h"

namespace quintet::app {

struct SceneSource {
  std::filesystem::path file;          // empty: the program's own, else the built-in scene
  std::string name;                    // for messages and metadata; the path of the program's own
  std::string text;                    // of the program's own (.scene.toml); empty: it has none
  scene::DefaultSceneOptions builtIn;  // what of it the program's hit groups can meet
  bool operator==(const SceneSource&) const = default;
};

// `asked`, or the scene that the program names, or the built-in one. Throws FileError if it cannot be read.
SceneSource chooseScene(const std::filesystem::path& asked, const program::Program& program);

// Throws FileError, UsageError.
scene::Scene loadScene(const SceneSource& source, const scene::Described& described = {});

// Every file on disk that loadScene reads, for --watch; those that cannot be found are left out.
std::vector<std::filesystem::path> sceneFiles(const SceneSource& source);

}  // namespace quintet::app
#endif
