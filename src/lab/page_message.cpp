// SPDX-License-Identifier: Apache-2.0
#include "lab/page_message.h"

#include <span>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/embedded.h"
#include "base/error.h"
#include "base/json.h"
#include "job/interactive/command_json.h"
#include "lab/unsaved_program.h"

namespace quintet {

std::span<const EmbeddedFile> embeddedLabProtocol();  // lab_protocol.json

namespace lab {
namespace {

using Json = nlohmann::json;

std::string takeId(Json& object) {
  const auto id = object.find("id");
  if (id == object.end()) return {};
  if (!id->is_number() && !id->is_string()) throw UsageError("'id' must be a number or a text");
  std::string text = id->dump(-1, ' ', false, Json::error_handler_t::replace);
  object.erase(id);
  return text;
}

std::uint32_t wholeAt(const Json& message, const char* name) { return message.at(name).get<std::uint32_t>(); }

uvec2 sizeOf(const Json& message) { return {wholeAt(message, "width"), wholeAt(message, "height")}; }

std::vector<std::pair<std::string, std::string>> parseFiles(const Json& object) {
  if (object.empty()) throw UsageError("'files' must have a file");
  std::vector<std::pair<std::string, std::string>> files;
  for (const auto& [name, text] : object.items()) {
    if (!isUnsavedName(name)) throw UsageError(fmt::format("'{}' is not the name of a file", name));
    files.emplace_back(name, text.get<std::string>());
  }
  return files;
}

OpenSession parseOpen(const Json& message) {
  OpenSession open;
  if (message.contains("files"))
    open.files = parseFiles(message["files"]);
  else if (message.contains("program"))
    open.program = message["program"].get<std::string>();
  else
    throw UsageError("'program' is missing");
  for (const auto& [name, value] : message.at("parameters").items())
    open.parameters.emplace_back(name, job::interactive::assignedValue(value));
  open.scene = message.at("scene").get<std::string>();
  if (message.contains("width")) open.size = sizeOf(message);
  if (message.contains("samples")) open.samples = wholeAt(message, "samples");
  open.output = message.at("output").get<std::string>();
  open.exposure = message.at("exposure").get<double>();
  open.toneMap = message.at("tonemap").get<std::string>();
  if (message.contains("frame")) open.frame = message["frame"].get<float>();
  if (!message.at("camera").is_null()) open.camera = job::interactive::parseCamera(message["camera"]);
  open.seed = wholeAt(message, "seed");
  open.number = wholeAt(message, "number");
  return open;
}

PageCommand parseCommand(const Json& message) {
  const auto name = message.at("do").get<std::string>();
  if (name == "open") return parseOpen(message);
  if (name == "received") return ImageReceived{wholeAt(message, "image")};
  if (name == "pause") return PauseSession{message.at("on").get<bool>()};
  if (name == "advance") return AdvanceFrames{wholeAt(message, "frames"), message.value("until", 0u)};
  if (name == "pick") return PickPixel{job::interactive::parsePixel(message)};
  if (name == "value") return ReadValue{job::interactive::parsePixel(message), sizeOf(message)};
  if (name == "explain") return ExplainSample{job::interactive::parsePixel(message), wholeAt(message, "sample")};
  if (name == "graph") return DescribeGraph{};
  if (name == "instrument") return InstrumentProgram{};
  if (name == "exr") return ExportExr{};
  if (name == "video")
    return RenderVideo{wholeAt(message, "frames"), message.at("fps").get<double>(),
                       message.at("format").get<std::string>(), message.at("turn").get<bool>()};
  if (name == "read") return ReadFilePart{wholeAt(message, "file"), message.at("offset").get<std::uint64_t>()};
  if (name == "restart") return RestartWorker{};
  return job::interactive::parseCommand(message);
}

}  // namespace

const job::interactive::MessageSchema& labSchema() {
  static const job::interactive::MessageSchema kSchema(
      {job::interactive::sessionProtocol(), embeddedLabProtocol().front().data});
  return kSchema;
}

std::variant<PageMessage, PageMessageError> parsePageMessage(std::string_view text) {
  Json object = findJson(text).value_or(nullptr);
  if (!object.is_object()) return PageMessageError{"the message is no JSON object", ""};
  std::string id;
  try {
    id = takeId(object);
    return PageMessage{parseCommand(labSchema().completeCommand(std::move(object))), id};
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

}  // namespace lab
}  // namespace quintet
