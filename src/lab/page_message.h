// SPDX-License-Identifier: Apache-2.0
// The commands of a page as data: those of the lab, which lab_protocol.json describes, and those of sessions
// (job/interactive/command_json.h).
#ifndef QUINTET_LAB_PAGE_MESSAGE_H
#define QUINTET_LAB_PAGE_MESSAGE_H

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "base/math.h"
#include "job/interactive/command.h"
#include "job/interactive/message_schema.h"

namespace quintet::lab {

inline constexpr std::size_t kMaxPageMessage = std::size_t{1} << 20;  // bytes

// Replaces the session. What is unset has the default of the project.
struct OpenSession {
  std::string program, scene;
  std::vector<std::pair<std::string, std::string>>
      files;  // name, text: a program that is not saved; `program` is empty
  std::optional<uvec2> size;
  std::optional<std::uint32_t> samples;
  std::vector<std::pair<std::string, std::string>> parameters;  // name, value as in SetParameter
  std::string output;
  double exposure = 0;
  std::string toneMap = "default";
  std::optional<float> frame;
  std::optional<job::CameraRequest> camera;
  std::uint32_t seed = 0;
  std::uint32_t number = 0;  // repeated by the event "opening"
};
struct ImageReceived {
  std::uint32_t image = 0;
};
struct PauseSession {
  bool on = true;
};
// Pauses, and renders this many further frames or batches of samples; or until there are `until`, also after later changes.
struct AdvanceFrames {
  std::uint32_t count = 1;
  std::uint32_t until = 0;  // 0: `count` decides
};
struct PickPixel {
  uvec2 pixel{0};
};
// The mean of a block of pixels.
struct ReadValue {
  uvec2 pixel{0};  // its first
  uvec2 size{1};   // pixels, at least 1
};
struct ExplainSample {
  uvec2 pixel{0};
  std::uint32_t sample = 0;
};
struct DescribeGraph {};
struct InstrumentProgram {};  // a short render with run-time checks
struct ExportExr {};          // the image as OpenEXR, 32-bit floats
// A video of frames: of a program that counts them, of an animated scene, or of a turn of the camera.
struct RenderVideo {
  std::uint32_t frames = 1;
  double framesPerSecond = 24;
  std::string format = "mp4";  // extension: mp4, webm or gif
  bool turn = false;           // once around the scene
};
// A part of a file that the page downloads.
struct ReadFilePart {
  std::uint32_t file = 0;  // number
  std::uint64_t offset = 0;
};
struct RestartWorker {};  // handled by the server

using PageCommand = std::variant<OpenSession, job::interactive::Command, ImageReceived, PauseSession, AdvanceFrames,
                                 PickPixel, ReadValue, ExplainSample, DescribeGraph, InstrumentProgram, ExportExr,
                                 RenderVideo, ReadFilePart, RestartWorker>;

struct PageMessage {
  PageCommand command;
  std::string id;  // JSON text of the member "id"; empty if it is missing
};

// A message with an error, and its id, so that the page gets an answer.
struct PageMessageError {
  std::string message;
  std::string id;
};

// The schema of sessions with the messages of the lab: all commands of a page, and all events of its session.
const job::interactive::MessageSchema& labSchema();

// The schema checks types and ranges; the worker checks names.
std::variant<PageMessage, PageMessageError> parsePageMessage(std::string_view text);

// The member "do" of an object; nothing if the text is no object with such a text.
std::optional<std::string> commandName(std::string_view text);

}  // namespace quintet::lab
#endif
