// A program: ray tracing shaders plus what connects them (program.toml, docs/programs.md). This is
// its description as read from a folder; link.h turns it into a pipeline for one device.
#ifndef QUINTET_PROGRAM_PROGRAM_H
#define QUINTET_PROGRAM_PROGRAM_H

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "program/parameter.h"
#include "shader/compiler.h"

namespace quintet::program {

// A stage is a file of the program's folder ("main.rgen"), or one of the shader library
// ("<quintet/stages/surface.rchit>").
bool isLibraryStage(const std::string& file);

// Values of the fields of the shader record (Program::record), one per field; empty: all defaults.
using RecordValues = std::vector<ParameterValue>;

// `line` in the structs below: where program.toml says it, 1-based; 0: not from a file.

// Files of one hit group for one ray type; empty: that stage is absent.
struct HitShaders {
  std::string closestHit;
  std::string anyHit;
  std::string intersection;
  RecordValues record;
  int line = 0;
};

// A hit group is bound to geometry by names; hitGroupFor (link.h) says which of several wins.
struct HitGroup {
  std::string name;
  std::vector<std::string> geometry;          // kinds or classes: geometryClasses()
  std::vector<std::string> material;          // names of materials
  std::vector<std::string> primitives;        // names of primitive sets or meshes
  std::map<std::string, HitShaders> shaders;  // by ray type
  int line = 0;
};

// What HitGroup::geometry may name: "triangles", "solids", "csg", "custom", "procedural" (any boxes), "opaque", "alpha",
// "thin" (shadow rays may pass; without a group of this class it counts as opaque).
const std::vector<std::string>& geometryClasses();

// A ray type; its position is its offset in the shader binding table and the index of its miss shader.
struct RayType {
  std::string name;
  std::string miss;  // file
  RecordValues record;
  int line = 0;
};

// A miss shader besides those of the ray types.
struct MissShader {
  std::string name;
  std::string file;
  RecordValues record;
  int line = 0;
};

struct Callable {
  std::string name;  // may be empty: no constant
  std::string file;
  RecordValues record;
  int line = 0;
};

// What the numbers of an output are: how a picture of it is best shown. display: sRGB-encoded, as a screen shows them;
// all others are linear.
enum class OutputKind { color, linear, normal, depth, id, display };
std::string_view outputKindName(OutputKind);  // as in program.toml

// What a pixel's samples become, where the film accumulates.
enum class OutputPixel {
  mean,      // the average of all samples: the program adds each to the sum
  center,    // one value: the program stores it with sample 0, of the ray through the pixel's centre
  coverage,  // how many samples met which id: the program stores the id (not 0) of sample s in word s % kBatchSamples
};
std::string_view outputPixelName(OutputPixel);  // as in program.toml

struct Output {
  std::string name;
  OutputKind kind = OutputKind::color;
  std::string help;
  OutputPixel pixel = OutputPixel::mean;
  bool optional = false;  // made only when asked for: then QUINTET_OUTPUT_name is defined
  int line = 0;
  std::vector<std::string> channels;  // names of its components in a file of layers; empty: outputChannels()
};

// Its channels: as program.toml says, else R, G, B for colours, X, Y, Z for normals and other quantities, Z for depth,
// X for ids.
std::vector<std::string> outputChannels(const Output& output);
// Channels R, G and B hold a colour: it may be stored with few bits. All else is data.
bool holdsColor(const Output& output);

// Who averages the samples of a pixel.
enum class Accumulation {
  film,     // an output is a sum over the samples of a batch; the film divides
  program,  // each launch is a frame (frameID) and overwrites the pixel; the program may read the previous one
};

struct Program {
  std::string name;  // the folder's
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
  std::vector<Parameter> record;  // fields of the shader record; empty: records carry no data
  // Depth of nested traceRayEXT that the author promises not to exceed; 1: only ray generation traces.
  std::optional<std::uint32_t> declaredRecursion;
  Accumulation accumulation = Accumulation::film;
  bool keepsInstanceOrder = false;  // gl_InstanceID is the instance's index in the scene (costs speed on lavapipe)
  // Any-hit shaders are asked about geometry without alpha, too; not about instances forced to be opaque.
  bool anyHitForAll = false;
  std::uint32_t samplesPerLaunch = 1;  // samples per pixel that the ray generation shader can loop over
  bool adaptive =
      false;  // the ray generation shader asks launchPixel() and launchActive(): pixels may differ in samples

  // What a front end found (lecture.h): an error here is a program that does not compile.
  std::vector<shader::Diagnostic> diagnostics;

  // Default scene, a file of the program: what [program] or the lecture file's comment "// scene: FILE" names, else
  // the folder's only *.scene.toml; empty: none.
  std::string scene;

  std::string origin;                            // folder, or "<programs/NAME>" when built in
  std::string descriptionFile = "program.toml";  // the file of `line`s, relative to origin
  std::map<std::string, std::string> files;      // every file of the folder: relative path → text

  // Path of a file as diagnostics show it.
  std::string path(const std::string& file) const {
    return isLibraryStage(file) || origin.empty() ? file : origin + "/" + file;
  }
};

// Every miss shader in the order of the table: those of the ray types, then the others.
std::vector<MissShader> missShaders(const Program& program);
std::vector<std::string> outputNames(const Program& program);

// Sets `program.scene` to the only *.scene.toml of its files if nothing else was named.
void chooseDefaultScene(Program& program);

// `nameOrFolder`: a folder with program.toml (or that file itself), a file NAME.rt.glsl (lecture.h), or the name of
// a built-in program ("lessons/05_shadow"; "05_shadow" and "shadow" do where only one fits). Throws FileError (with line) for a description that is wrong, UsageError with the nearest
// name for a program that does not exist.
Program loadProgram(const std::string& nameOrFolder);

// program.toml's text alone; `files` are the folder's.
Program parseProgram(const std::string& toml, const std::string& name, const std::string& origin,
                     std::map<std::string, std::string> files);

std::vector<std::string> builtInPrograms();

}  // namespace quintet::program
#endif
