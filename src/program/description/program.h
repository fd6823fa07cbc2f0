// SPDX-License-Identifier: Apache-2.0
// The description of a program: ray tracing shaders and how they connect (program.toml, docs/programs.md). Plain structs
// without a device: load.h reads them, compile.h makes SPIR-V, linked/ makes a pipeline.
#ifndef QUINTET_PROGRAM_DESCRIPTION_PROGRAM_H
#define QUINTET_PROGRAM_DESCRIPTION_PROGRAM_H

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostic.h"
#include "program/description/parameter.h"

namespace quintet::program {

// Returns whether a stage is one of the shader library ("<quintet/stages/surface.rchit>") rather than a file of the
// program's folder ("main.rgen").
bool isLibraryStage(const std::string& file);

// Values of the fields of the shader record (Program::record), one per field. Empty means all defaults.
using RecordValues = std::vector<ParameterValue>;

// `line` in the structs below is the 1-based line of the declaration in Program::descriptionFile; 0 if unknown.

// Shader files of one hit group for one ray type. An empty name means that the hit group lacks this stage.
struct HitShaders {
  std::string closestHit;
  std::string anyHit;
  std::string intersection;
  RecordValues record;
  int line = 0;
};

// A hit group is bound to geometry by names; hitGroupFor (hit_group_binding.h) resolves several matches.
struct HitGroup {
  std::string name;
  std::vector<std::string> geometry;          // kinds or classes: geometryClasses()
  std::vector<std::string> material;          // names of materials
  std::vector<std::string> primitives;        // names of primitive sets or meshes
  std::map<std::string, HitShaders> shaders;  // by ray type
  int line = 0;
};

// Valid names in HitGroup::geometry: "triangles", "solids", "csg", "custom", "procedural" (all boxes), "opaque", "alpha",
// "thin" (shadow rays can pass; geometry of this class counts as opaque if no group has the class).
const std::vector<std::string>& geometryClasses();

// A ray type. Its position is its offset in the shader binding table and the index of its miss shader.
struct RayType {
  std::string name;
  std::string miss;  // file
  RecordValues record;
  int line = 0;
};

// A miss shader in addition to those of the ray types.
struct MissShader {
  std::string name;
  std::string file;
  RecordValues record;
  int line = 0;
};

struct Callable {
  std::string name;  // empty if no constant is generated
  std::string file;
  RecordValues record;
  int line = 0;
};

// Meaning of an output's numbers, which decides how an image shows them. `display` values are sRGB-encoded, all others are
// linear. `heat` is one quantity, which PNG files show in false colors.
enum class OutputKind { color, linear, normal, depth, id, display, heat };
std::string_view outputKindName(OutputKind);  // as in program.toml

// How the film combines the samples of a pixel.
enum class OutputPixel {
  mean,      // the average of all samples: the program adds each sample to the sum
  center,    // one value: the program stores it with sample 0, for the ray through the pixel's center
  coverage,  // number of samples per id: the program stores the id (not 0) of sample s in word s % kBatchSamples
};
std::string_view outputPixelName(OutputPixel);  // as in program.toml

struct Output {
  std::string name;
  OutputKind kind = OutputKind::color;
  std::string help;
  OutputPixel pixel = OutputPixel::mean;
  bool optional = false;  // rendered only on request; QUINTET_OUTPUT_name is then defined
  int line = 0;
  std::vector<std::string> channels;  // names of the components in an EXR layer; outputChannels() if empty
  bool isHeatMap = false;             // an instrumented variant of the program writes it (program/heat.h)
};

// Returns the channel names: those in program.toml, else R, G, B for colors; X, Y, Z for normals and linear quantities;
// Z for depth; X for ids and heat.
std::vector<std::string> outputChannels(const Output& output);
// Returns whether channels R, G and B hold a color, which can be stored with reduced precision; all else is data.
bool holdsColor(const Output& output);

// Who averages the samples of a pixel.
enum class Accumulation {
  film,     // an output is a sum over the samples of a batch; the film divides
  program,  // each launch is a frame (frameID) and overwrites the pixel; the program can read the previous frame
};

struct Program {
  std::string name;  // of the folder or file
  std::string description;
  std::string rayGeneration;  // file
  RecordValues rayGenerationRecord;
  int rayGenerationLine = 0;
  std::vector<RayType> rays;
  std::vector<MissShader> misses;  // their indices follow those of `rays`: missShaders()
  std::vector<HitGroup> hitGroups;
  std::vector<Callable> callables;
  std::vector<Output> outputs;  // index = slot
  std::vector<Parameter> parameters;
  std::vector<Parameter> record;  // fields of the shader record; empty if records carry no data
  // Depth of nested traceRayEXT that the author promises not to exceed; 1 if only ray generation traces.
  std::optional<std::uint32_t> declaredRecursion;
  Accumulation accumulation = Accumulation::film;
  bool keepsInstanceOrder = false;     // gl_InstanceID is the instance's index in the scene (slower on lavapipe)
  bool mergesInstances = false;        // hit shaders identify triangles only by triangleHit() of quintet/hit.glsl
  bool anyHitForAll = false;           // any-hit shaders also run for geometry without alpha, unless forced opaque
  std::uint32_t samplesPerLaunch = 1;  // samples per pixel that the ray generation shader can loop over
  bool adaptive = false;  // ray generation uses launchPixel() and launchActive(): sample counts can differ per pixel

  std::vector<Diagnostic> diagnostics;  // from the lecture form; a program with an error does not compile

  // File of the default scene: the one that [program] or the comment "// scene: FILE" names, else the only *.scene.toml
  // of the program's files; empty if none.
  std::string scene;

  std::string origin;                            // folder, or "<programs/NAME>" if built in
  std::string descriptionFile = "program.toml";  // file that `line` refers to, relative to origin
  std::map<std::string, std::string> files;      // every file of the program: relative path → text

  // Returns the path of a file as diagnostics show it.
  std::string path(const std::string& file) const {
    return isLibraryStage(file) || origin.empty() ? file : origin + "/" + file;
  }
};

// Returns every miss shader in table order: those of the ray types, then the others.
std::vector<MissShader> missShaders(const Program& program);
std::vector<std::string> outputNames(const Program& program);
std::vector<std::string> optionalOutputs(const Program& program);  // names
// Returns the macro that is defined if an optional output is rendered: "QUINTET_OUTPUT_albedo".
std::string outputMacro(const std::string& name);

// Sets `program.scene` to the only *.scene.toml among its files unless a scene is already named.
void chooseDefaultScene(Program& program);

}  // namespace quintet::program
#endif
