// SPDX-License-Identifier: Apache-2.0
// What a front end can do in a session, as plain data. Names are those of the scene: scene::instanceNames(),
// scene::materialNames() and scene::lightNames().
#ifndef QUINTET_JOB_INTERACTIVE_COMMAND_H
#define QUINTET_JOB_INTERACTIVE_COMMAND_H

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "base/math.h"
#include "job/request.h"
#include "render/tone_map/tone_map.h"

namespace quintet::job::interactive {

// Navigation (orbit_camera.h).
struct Orbit {
  float right = 0, up = 0;  // degrees
};
struct Pan {
  vec2 pixels{0.0f};  // x right, y down
};
struct Zoom {
  float factor = 1;           // > 0; above 1 moves closer
  std::optional<vec2> pixel;  // that stays; unset means the middle of the image
};
struct Fly {
  vec3 meters{0.0f};         // right, up, forward
  float yaw = 0, pitch = 0;  // degrees
};
struct Frame {
  std::string instance;  // empty means the whole scene
};
// Orbit turns around this point from now on, and the camera focuses on it. The camera does not move.
struct SetOrbitCenter {
  vec3 point{0.0f};  // world space, in front of the camera
};
struct SetCamera {
  CameraRequest camera;
};
struct SetLens {
  std::optional<float> verticalFov;     // degrees, (0, 180)
  std::optional<float> apertureRadius;  // meters, ≥ 0
  std::optional<float> focusDistance;   // meters, > 0
};

// A program: name, folder or file, as for program::loadProgram(). Parameters get their defaults, and the first output
// is shown.
struct SetProgram {
  std::string name;
};
struct SetParameter {
  std::string name, value;  // as in RenderRequest::assignments
};

// A property by name. Flags are 0 or 1.
struct Property {
  std::string name;
  std::vector<double> numbers;
};
// These change properties; the others stay.
struct EditMaterial {
  std::string material;
  std::vector<Property> properties;  // material_properties.h
};
struct EditLight {
  std::string light;
  std::vector<Property> properties;  // light_properties.h, and "on"
};
struct SetEnvironment {
  std::optional<std::string> source;  // EnvironmentRequest::source
  std::optional<float> intensity;     // factor, ≥ 0
  std::optional<float> rotation;      // degrees about +y, counter-clockwise seen from above
  std::optional<bool> on;
};
struct SetTransform {
  std::string instance;
  mat4 worldFromObject{1.0f};
};
struct Move {
  std::string instance;
  vec3 meters{0.0f};  // world space
};
struct SetFrame {
  float frame = 0;
};

struct SelectOutput {
  std::string name;
};
struct SetExposure {
  double stops = 0;
};
struct SetToneMap {
  std::optional<render::ToneMap> toneMap;  // unset means by the kind of output
};
struct SetSize {
  uvec2 size{0};
  bool ofWindow = false;  // no step of undo, and from now on undo keeps the size
};
struct SetSamples {
  std::uint32_t samples = 64;  // per pixel, which refinement reaches; or frames
};

// What the program prints for these pixels of the image (debugPrintfEXT) becomes LinesPrinted. No step of undo, and
// undo keeps it.
struct SetPrint {
  std::optional<PrintRequest> print;  // with pixels, or for all; unset: nothing is printed
};

// Discards the samples: refinement starts over, and a program that accumulates begins with frame 0. No step of undo.
struct Rewind {};

// Commands of the same kind that change the same thing, one after the other, are one step of undo, until EndDrag.
struct EndDrag {};
struct Undo {};
struct Redo {};

using Command = std::variant<Orbit, Pan, Zoom, Fly, Frame, SetOrbitCenter, SetCamera, SetLens, SetProgram, SetParameter,
                             EditMaterial, EditLight, SetEnvironment, SetTransform, Move, SetFrame, SelectOutput,
                             SetExposure, SetToneMap, SetSize, SetSamples, SetPrint, Rewind, EndDrag, Undo, Redo>;

// What a command changes: the kind of the command and its target. Commands of the same group, one after the other, are
// one step of undo; an empty group is a step of its own.
std::string undoGroup(const Command& command);
// What a step of undo changes, for a menu: "move of 'Lamp'". Empty for commands that are no steps.
std::string undoName(const Command& command);

}  // namespace quintet::job::interactive
#endif
