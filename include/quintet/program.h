// SPDX-License-Identifier: Apache-2.0
// Programs: ray tracing shaders and the description that connects them.
#ifndef QUINTET_PROGRAM_H
#define QUINTET_PROGRAM_H

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <quintet/diagnostic.h>
#include <quintet/error.h>
#include <quintet/scene.h>

namespace quintet {

// A parameter that a program declares.
struct ParameterInfo {
  std::string name{};
  std::string type{};          // "bool", "int", "float", "vec2", "vec3", "vec4", "color", …: docs/programs.md
  std::string defaultValue{};  // in the form of Settings::parameters
  double min = 0, max = 0;     // of each component, inclusive
  std::string unit{};          // "m", "deg", …; can be empty
  std::string help{};
};

// An image or layer that a program renders.
struct OutputInfo {
  std::string name{};
  std::string help{};
  std::vector<std::string> channels{};  // "R", "G", "B"; "Z"; "X"
  bool optional = false;                // rendered only if Settings::outputs names it
};

// Ray tracing shaders and the description that connects them. Copies share their data. Shaders are compiled by Renderer.
class Program {
 public:
  // Reads a folder with program.toml, a .rt.glsl file, or the built-in program of this name. Throws FileError, UsageError.
  static Program load(const std::string& nameOrPath);
  // Makes a program from the text of a .rt.glsl file. `name` without extension is used in diagnostics. Errors in the text are
  // diagnostics: checkProgram() returns them, Renderer throws them.
  static Program fromSource(std::string_view text, const std::string& name = "program");
  // Makes a program from the files of its folder by name, "program.toml" among them. Throws FileError with a line.
  static Program fromFiles(std::map<std::string, std::string> files, const std::string& name = "program");
  static std::vector<std::string> builtIn();  // names

  std::string name() const;                       // of the folder or file
  std::string description() const;                // one sentence; can be empty
  std::vector<ParameterInfo> parameters() const;  // in the order of their declaration
  // The image is the first one. Film::layer() takes the names of the others that were rendered, and of "variance" and
  // "sample_count".
  std::vector<OutputInfo> outputs() const;

 private:
  friend class Renderer;
  friend class Scene;
  friend std::vector<Diagnostic> checkProgram(const Program&, const Scene*);
  struct Impl;
  const Impl& impl() const;  // throws UsageError for an empty object
  std::shared_ptr<const Impl> impl_;
};

// Compiles and links a program without a device and returns every mismatch, with the ids of docs/diagnostics. A scene adds
// the rules that depend on it. Renderer checks the same and throws if there are errors.
std::vector<Diagnostic> checkProgram(const Program& program, const Scene* scene = nullptr);

}  // namespace quintet
#endif
