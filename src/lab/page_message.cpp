// SPDX-License-Identifier: Apache-2.0
#include "lab/page_message.h"

#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/json.h"
#include "job/interactive/command_json.h"
#include "job/interactive/json_fields.h"
#include "lab/unsaved_program.h"

namespace quintet::lab {
namespace {

using job::interactive::JsonFields;
using Json = nlohmann::json;

const std::vector<std::string> kLabCommands{"open",    "received", "pause", "advance", "pick", "value",
                                            "explain", "graph",    "exr",   "video",   "read", "restart"};

std::string idOf(const Json& object) {
  const auto id = object.find("id");
  if (id == object.end()) return {};
  if (!id->is_number() && !id->is_string()) throw UsageError("'id' must be a number or a text");
  return id->dump(-1, ' ', false, Json::error_handler_t::replace);
}

void requireSize(uvec2 size) {
  if (size.x > kMaxSide || size.y > kMaxSide)
    throw UsageError(fmt::format("the image of {}x{} is larger than {}x{}", size.x, size.y, kMaxSide, kMaxSide));
}

// "value" of each member, in the form of SetParameter.
std::vector<std::pair<std::string, std::string>> parseParameters(const Json& object) {
  if (!object.is_object()) throw UsageError("'parameters' must be an object");
  std::vector<std::pair<std::string, std::string>> parameters;
  for (const auto& [name, value] : object.items()) {
    JsonFields fields(Json{{"value", value}}.dump(-1, ' ', false, Json::error_handler_t::replace));
    try {
      parameters.emplace_back(name, fields.assignedValue("value"));
    } catch (const UsageError&) {
      throw UsageError(fmt::format(
          "the value of the parameter '{}' must be a number, true, false, a text, or a list of numbers", name));
    }
  }
  return parameters;
}

job::CameraRequest parseCamera(const Json& object) {
  if (!object.is_object()) throw UsageError("'camera' must be an object");
  JsonFields fields(object.dump(-1, ' ', false, Json::error_handler_t::replace));
  job::CameraRequest camera;
  camera.lookFrom = fields.findPoint("from");
  if (!camera.lookFrom) throw UsageError("'from' of the camera is missing");
  camera.lookAt = fields.findPoint("at");
  camera.up = fields.findPoint("up").value_or(camera.up);
  if (const auto fov = fields.findNumber("fov")) camera.verticalFov = static_cast<float>(*fov);
  if (const auto aperture = fields.findNumber("aperture")) camera.apertureRadius = static_cast<float>(*aperture);
  if (const auto focus = fields.findNumber("focus")) camera.focusDistance = static_cast<float>(*focus);
  fields.rejectOthers();
  return camera;
}

std::vector<std::pair<std::string, std::string>> parseFiles(const Json& object) {
  if (!object.is_object() || object.empty()) throw UsageError("'files' must be an object with texts");
  std::vector<std::pair<std::string, std::string>> files;
  for (const auto& [name, text] : object.items()) {
    if (!isUnsavedName(name)) throw UsageError(fmt::format("'{}' is not the name of a file", name));
    if (!text.is_string()) throw UsageError(fmt::format("'{}' of 'files' must be a text", name));
    files.emplace_back(name, text.get<std::string>());
  }
  return files;
}

PageCommand parseOpen(const Json& object) {
  Json simple = object;
  OpenSession open;
  if (const auto found = object.find("parameters"); found != object.end()) open.parameters = parseParameters(*found);
  if (const auto found = object.find("camera"); found != object.end() && !found->is_null())
    open.camera = parseCamera(*found);
  if (const auto found = object.find("files"); found != object.end()) open.files = parseFiles(*found);
  simple.erase("files");
  simple.erase("parameters");
  simple.erase("camera");
  JsonFields fields(simple.dump(-1, ' ', false, Json::error_handler_t::replace));
  static_cast<void>(fields.text("do"));
  if (open.files.empty()) open.program = fields.text("program");
  open.scene = fields.findText("scene").value_or("");
  if (fields.has("width") || fields.has("height")) {
    open.size = uvec2(fields.count("width"), fields.count("height"));
    requireSize(*open.size);
  }
  if (fields.has("samples")) open.samples = fields.count("samples");
  open.output = fields.findText("output").value_or("");
  open.exposure = fields.findNumber("exposure").value_or(0);
  open.toneMap = fields.findText("tonemap").value_or("default");
  if (const auto frame = fields.findNumber("frame")) open.frame = static_cast<float>(*frame);
  if (fields.has("seed")) open.seed = fields.index("seed");
  if (fields.has("number")) open.number = fields.index("number");
  fields.rejectOthers();
  return open;
}

uvec2 parsePixel(JsonFields& fields) {
  const std::uint32_t x = fields.index("x");
  return {x, fields.index("y")};
}

ReadValue parseValue(JsonFields& fields) {
  ReadValue value{.pixel = parsePixel(fields)};
  if (fields.has("width") || fields.has("height")) value.size = uvec2(fields.count("width"), fields.count("height"));
  return value;
}

RenderVideo parseVideo(JsonFields& fields) {
  RenderVideo video{.frames = fields.count("frames")};
  if (video.frames > kMaxVideoFrames) throw UsageError(fmt::format("a video has at most {} frames", kMaxVideoFrames));
  video.framesPerSecond = fields.findNumber("fps").value_or(video.framesPerSecond);
  if (!(video.framesPerSecond > 0) || video.framesPerSecond > kMaxFrameRate)
    throw UsageError(fmt::format("'fps' must be above 0 and at most {:g}", kMaxFrameRate));
  video.format = fields.findText("format").value_or(video.format);
  if (video.format != "mp4" && video.format != "webm" && video.format != "gif")
    throw UsageError(fmt::format("unknown format '{}'; available: mp4, webm, gif", video.format));
  video.turn = fields.findFlag("turn").value_or(video.turn);
  return video;
}

ReadFilePart parseFilePart(JsonFields& fields) {
  const std::uint32_t file = fields.index("file");
  const double offset = fields.findNumber("offset").value_or(0);
  constexpr double kLargest = 9007199254740992.0;  // 2^53: exact in JSON
  if (!(offset >= 0) || offset > kLargest || offset != std::floor(offset))
    throw UsageError("'offset' must be a whole number");
  return {file, static_cast<std::uint64_t>(offset)};
}

PageCommand parseCommand(const Json& object) {
  JsonFields fields(object.dump(-1, ' ', false, Json::error_handler_t::replace));
  const std::string name = fields.text("do");
  if (name == "open") return parseOpen(object);
  PageCommand command;
  if (name == "received") {
    command = ImageReceived{fields.index("image")};
  } else if (name == "pause") {
    command = PauseSession{fields.findFlag("on").value_or(true)};
  } else if (name == "advance") {
    command = AdvanceFrames{fields.has("frames") ? fields.count("frames") : 1,
                            fields.has("until") ? fields.count("until") : 0};
  } else if (name == "pick") {
    command = PickPixel{parsePixel(fields)};
  } else if (name == "value") {
    command = parseValue(fields);
  } else if (name == "explain") {
    const uvec2 pixel = parsePixel(fields);
    command = ExplainSample{pixel, fields.has("sample") ? fields.index("sample") : 0};
  } else if (name == "graph") {
    command = DescribeGraph{};
  } else if (name == "instrument") {
    command = InstrumentProgram{};
  } else if (name == "exr") {
    command = ExportExr{};
  } else if (name == "video") {
    command = parseVideo(fields);
  } else if (name == "read") {
    command = parseFilePart(fields);
  } else if (name == "restart") {
    command = RestartWorker{};
  } else {
    job::interactive::Command session = job::interactive::parseCommand(name, fields, kLabCommands);
    if (const auto* size = std::get_if<job::interactive::SetSize>(&session)) requireSize(size->size);
    return session;
  }
  fields.rejectOthers();
  return command;
}

}  // namespace

std::variant<PageMessage, PageMessageError> parsePageMessage(std::string_view text) {
  Json object = findJson(text).value_or(nullptr);
  if (!object.is_object()) return PageMessageError{"the message is no JSON object", ""};
  std::string id;
  try {
    id = idOf(object);
    object.erase("id");
    return PageMessage{parseCommand(object), id};
  } catch (const Error& error) {
    return PageMessageError{error.what(), id};
  } catch (const nlohmann::json::exception& error) {
    return PageMessageError{error.what(), id};
  }
}

std::optional<std::string> commandName(std::string_view text) {
  const Json object = findJson(text).value_or(nullptr);
  if (!object.is_object()) return {};
  const auto name = object.find("do");
  if (name == object.end() || !name->is_string()) return {};
  return name->get<std::string>();
}

}  // namespace quintet::lab
