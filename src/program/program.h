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

namespace quintet::program {

// A stage is a file of the program's folder ("main.rgen"), or one of the shader library
// ("<quintet/stages/surface.rchit>").
bool isLibraryStage(const std::string& file);

// Files of one hit group for one ray type; empty: that stage is absent.
struct HitShaders {
  std::string closestHit;
  std::string anyHit;
  std::string intersection;
};

// A hit group is bound to geometry by name; hitGroupFor (link.h) says which of several wins.
struct HitGroup {
  std::string name;
  std::string geometry;    // kind or class: "triangles", "solids", "csg", "custom", "procedural" (any boxes), "opaque", "alpha"
  std::string material;    // name of a material
  std::string primitives;  // name of a primitive set or mesh
  std::map<std::string, HitShaders> shaders;  // by ray type
};

// A ray type; its position is its offset in the shader binding table.
struct RayType {
  std::string name;
  std::string miss;  // file
};

// Who averages the samples of a pixel.
enum class Accumulation {
  film,     // an output is a sum over the samples of a batch; the film divides
  program,  // each launch is a frame (frameID) and overwrites the pixel; the program may read the previous one
};

struct Program {
  std::string name;                // the folder's
  std::string description;
  std::string rayGeneration;       // file
  std::vector<RayType> rays;
  std::vector<HitGroup> hitGroups;
  std::vector<std::string> callables;  // files
  std::vector<std::string> outputs;    // names; index = slot
  std::vector<Parameter> parameters;
  std::uint32_t maxRecursion = 1;      // nested traceRayEXT; 1: only ray generation traces
  Accumulation accumulation = Accumulation::film;
  bool keepsInstanceOrder = false;     // gl_InstanceID is the instance's index in the scene (costs speed on lavapipe)
  std::uint32_t samplesPerLaunch = 1;  // samples per pixel that the ray generation shader can loop over

  std::string origin;                        // folder, or "<programs/NAME>" when built in
  std::map<std::string, std::string> files;  // every file of the folder: relative path → text

  // Path of a file as diagnostics show it.
  std::string path(const std::string& file) const { return isLibraryStage(file) ? file : origin + "/" + file; }
};

// `nameOrFolder`: a folder with program.toml (or that file itself), or the name of a built-in
// program. Throws FileError (with line) for a description that is wrong, UsageError with the nearest
// name for a program that does not exist.
Program loadProgram(const std::string& nameOrFolder);

// program.toml's text alone; `files` are the folder's.
Program parseProgram(const std::string& toml, const std::string& name, const std::string& origin,
                     std::map<std::string, std::string> files);

std::vector<std::string> builtInPrograms();

// The GLSL that #include <quintet/generated/program.glsl> gives: ray types, strides, miss indices,
// output slots, and `parameters`.
std::string generatedConstants(const Program& program);

}  // namespace quintet::program
#endif
