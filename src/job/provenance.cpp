// SPDX-License-Identifier: Apache-2.0
#include "job/provenance.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/json.h"
#include "base/parse.h"
#include "base/text.h"

namespace quintet::job {
namespace {

using Role = ProvenanceField::Role;

constexpr std::string_view kParameterPrefix = "parameter ";

// Each type of a member: its value, and back from text. False: the text is not a valid value.
FieldValue toValue(const std::string& value) { return value; }
FieldValue toValue(bool value) { return value; }
FieldValue toValue(std::uint64_t value) { return value; }
FieldValue toValue(double value) { return value; }
FieldValue toValue(const uvec2& value) { return value; }
FieldValue toValue(const render::Region& value) { return value; }
FieldValue toValue(const mat4& value) { return value; }
FieldValue toValue(const PixelPosition& value) { return value; }
FieldValue toValue(const std::vector<std::string>& value) { return value; }
template <class T>
FieldValue toValue(const std::optional<T>& value) {
  return value ? toValue(*value) : FieldValue();
}

bool fromText(std::string& value, const std::string& text) {
  value = text;
  return true;
}
bool fromText(bool& value, const std::string& text) {
  value = text == "yes";
  return value || text == "no";
}
bool fromText(std::uint64_t& value, const std::string& text) {
  const auto number = parseNumber<std::uint64_t>(text);
  value = number.value_or(0);
  return number.has_value();
}
bool fromText(double& value, const std::string& text) {
  const auto number = parseNumber<double>(text);
  value = number.value_or(0);
  return number && std::isfinite(value);
}
template <std::size_t count>
bool parseList(std::array<std::uint32_t, count>& values, const std::string& text, char separator) {
  const std::vector<std::string> parts = splitText(text, separator);
  if (parts.size() != count) return false;
  for (std::size_t i = 0; i < count; ++i) {
    const auto number = parseNumber<std::uint32_t>(parts[i]);
    if (!number || *number > io::kMaxImageSide) return false;
    values[i] = *number;
  }
  return true;
}
bool fromText(uvec2& value, const std::string& text) {
  std::array<std::uint32_t, 2> numbers{};
  if (!parseList(numbers, text, 'x')) return false;
  value = {numbers[0], numbers[1]};
  return value.x > 0 && value.y > 0;
}
bool fromText(render::Region& value, const std::string& text) {
  std::array<std::uint32_t, 4> numbers{};
  if (!parseList(numbers, text, ',')) return false;
  value = {numbers[0], numbers[1], numbers[2], numbers[3]};
  return value.width > 0 && value.height > 0;
}
bool fromText(PixelPosition& value, const std::string& text) {
  std::array<std::uint32_t, 2> numbers{};
  if (!parseList(numbers, text, ',')) return false;
  value = {numbers[0], numbers[1]};
  return true;
}
// In the order of an OpenEXR file, for row vectors.
bool fromText(mat4& value, const std::string& text) {
  const std::vector<std::string> parts = splitText(text, ' ');
  if (parts.size() != 16) return false;
  for (std::size_t i = 0; i < 16; ++i) {
    const auto number = parseNumber<float>(parts[i]);
    if (!number || !std::isfinite(*number)) return false;
    value[static_cast<glm::length_t>(i / 4)][static_cast<glm::length_t>(i % 4)] = *number;
  }
  return true;
}
bool fromText(std::vector<std::string>& value, const std::string& text) {
  value.clear();
  if (text.empty()) return true;
  const nlohmann::json list = findJson(text).value_or(nullptr);
  if (!list.is_array() || !std::ranges::all_of(list, [](const auto& name) { return name.is_string(); })) return false;
  value = list.get<std::vector<std::string>>();
  return true;
}
template <class T>
bool fromText(std::optional<T>& value, const std::string& text) {
  value.reset();
  return text.empty() || fromText(value.emplace(), text);
}

template <auto member>
constexpr ProvenanceField field(Role role, std::string_view name, std::string_view jsonKey,
                                std::string_view metadataKey) {
  return {name,
          jsonKey,
          metadataKey,
          role,
          [](const Provenance& p) { return toValue(p.*member); },
          [](Provenance& p, const std::string& text) {
            if (!fromText(p.*member, text)) throw UsageError(fmt::format("'{}' is not a valid value", printable(text)));
          }};
}

constexpr ProvenanceField onlyIfSet(ProvenanceField field) {
  field.onlyIfSet = true;
  return field;
}

using P = Provenance;

constexpr std::array kFields{
    // role, name in films, key in --json, key in PNG and OpenEXR
    field<&P::version>(Role::identity, "version", "version", ""),
    field<&P::commandLine>(Role::note, "command", "command", "Command"),
    field<&P::scene>(Role::note, "scene", "scene", "Scene"),
    field<&P::sceneHash>(Role::identity, "scene", "sceneHash", "SceneHash"),
    field<&P::environment>(Role::note, "environment", "environment", "Environment"),
    field<&P::environmentHash>(Role::identity, "environment", "environmentHash", ""),
    field<&P::camera>(Role::note, "camera", "camera", "Camera"),
    field<&P::program>(Role::identity, "program", "program", "Program"),
    field<&P::programHash>(Role::identity, "program files", "", ""),
    field<&P::libraryHash>(Role::identity, "shader library", "", ""),
    field<&P::output>(Role::result, "", "", "Output"),
    field<&P::parameters>(Role::note, "parameters", "parameters", "Parameters"),
    field<&P::projection>(Role::identity, "camera", "", ""),
    field<&P::cameraPosition>(Role::identity, "camera position", "", ""),
    field<&P::cameraAxes>(Role::identity, "camera axes", "", ""),
    field<&P::lens>(Role::identity, "camera lens", "", ""),
    field<&P::size>(Role::identity, "size", "size", "Size"),
    field<&P::region>(Role::identity, "region", "region", "Region"),
    field<&P::transparent>(Role::identity, "transparent", "transparent", "Transparent"),
    field<&P::toneMap>(Role::note, "tone map", "toneMap", "ToneMap"),
    field<&P::exposure>(Role::note, "exposure", "exposure", "Exposure"),
    field<&P::seed>(Role::identity, "seed", "seed", "Seed"),
    field<&P::plannedSamples>(Role::identity, "planned samples", "", ""),
    field<&P::samples>(Role::result, "", "samples", "Samples"),
    field<&P::adaptive>(Role::identity, "adaptive", "adaptive", "Adaptive"),
    onlyIfSet(field<&P::shutter>(Role::identity, "shutter", "shutter", "Shutter")),
    field<&P::outputs>(Role::identity, "outputs", "", ""),
    field<&P::frame>(Role::result, "", "frame", "Frame"),
    onlyIfSet(field<&P::framesPerSecond>(Role::note, "frames per second", "framesPerSecond", "FrameRate")),
    field<&P::rays>(Role::result, "", "rays", "Rays"),
    field<&P::droppedSamples>(Role::result, "", "droppedSamples", "DroppedSamples"),
    field<&P::firstDroppedSample>(Role::result, "", "firstDroppedSample", "FirstDroppedSample"),
    field<&P::notFinitePixels>(Role::result, "", "notFinitePixels", "NotFinitePixels"),
    field<&P::firstNotFinitePixel>(Role::result, "", "firstNotFinitePixel", "FirstNotFinitePixel"),
    field<&P::interrupted>(Role::result, "", "interrupted", "Interrupted"),
    field<&P::targetError>(Role::note, "target error", "", "TargetError"),
    field<&P::error>(Role::result, "", "", "Error"),
    field<&P::tileError>(Role::result, "", "", "TileError"),
    field<&P::device>(Role::note, "device", "device", "Device"),
    field<&P::driver>(Role::note, "driver", "driver", "Driver"),
    onlyIfSet(field<&P::deviceCount>(Role::note, "device count", "deviceCount", "DeviceCount")),
    onlyIfSet(field<&P::farmPlan>(Role::note, "farm plan", "", "FarmPlan")),
    field<&P::seconds>(Role::note, "seconds", "", "Seconds"),
    field<&P::batchSeconds>(Role::note, "batch seconds", "", ""),
    field<&P::allOutputs>(Role::note, "all outputs", "", ""),
    field<&P::layers>(Role::note, "layers", "", ""),
    field<&P::instanceNames>(Role::note, "instance names", "", ""),
    field<&P::materialNames>(Role::note, "material names", "", ""),
    field<&P::worldToCamera>(Role::note, "world to camera", "", ""),
    field<&P::worldToNdc>(Role::note, "world to NDC", "", ""),
};

}  // namespace

std::span<const ProvenanceField> provenanceFields() { return kFields; }

std::string toText(const FieldValue& value) {
  struct Visitor {
    std::string operator()(std::monostate) const { return ""; }
    std::string operator()(const std::string& text) const { return text; }
    std::string operator()(bool flag) const { return flag ? "yes" : "no"; }
    std::string operator()(std::uint64_t number) const { return fmt::format("{}", number); }
    std::string operator()(double number) const { return fmt::format("{}", number); }
    std::string operator()(const uvec2& size) const { return fmt::format("{}x{}", size.x, size.y); }
    std::string operator()(const render::Region& r) const {
      return fmt::format("{},{},{},{}", r.x, r.y, r.width, r.height);
    }
    std::string operator()(const PixelPosition& p) const { return fmt::format("{},{}", p.x, p.y); }
    std::string operator()(const mat4& m) const {
      std::string text;
      for (glm::length_t column = 0; column < 4; ++column)
        for (glm::length_t row = 0; row < 4; ++row)
          text += fmt::format("{}{}", text.empty() ? "" : " ", m[column][row]);
      return text;
    }
    std::string operator()(const std::vector<std::string>& list) const {
      if (list.empty()) return "";
      return nlohmann::json(list).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    }
  };
  return std::visit(Visitor{}, value);
}

render::FilmFacts toFacts(const Provenance& provenance, Role role) {
  render::FilmFacts facts;
  for (const ProvenanceField& f : kFields) {
    if (f.role != role) continue;
    std::string text = toText(f.get(provenance));
    if (!f.onlyIfSet || !text.empty()) facts.emplace_back(f.name, std::move(text));
  }
  if (role == Role::identity)
    for (const auto& [name, value] : provenance.parameterValues)
      facts.emplace_back(std::string(kParameterPrefix) + name, value);
  return facts;
}

Provenance fromFacts(const render::FilmFacts& identity, const render::FilmFacts& notes) {
  Provenance provenance;
  for (const ProvenanceField& f : kFields) {
    if (f.role == Role::result) continue;
    const std::string name(f.name);
    const std::string* text = render::findFact(f.role == Role::identity ? identity : notes, name);
    if (!text) continue;
    try {
      f.set(provenance, *text);
    } catch (const UsageError& error) {
      throw UsageError(fmt::format("{}: {}", name, error.what()));
    }
  }
  for (const auto& [name, value] : identity)
    if (name.starts_with(kParameterPrefix))
      provenance.parameterValues.emplace_back(name.substr(kParameterPrefix.size()), value);
  const render::Region& region = provenance.region;
  if (provenance.size.x == 0) throw UsageError("size is missing");
  if (region.width == 0) throw UsageError("region is missing");
  if (provenance.seconds < 0 || provenance.batchSeconds < 0) throw UsageError("seconds are negative");
  if (!(provenance.framesPerSecond.value_or(1.0) > 0)) throw UsageError("frames per second are not positive");
  if (std::abs(provenance.exposure.value_or(0.0)) > kMaxExposure) throw UsageError("exposure is out of range");
  if (std::uint64_t{region.x} + region.width > provenance.size.x ||
      std::uint64_t{region.y} + region.height > provenance.size.y)
    throw UsageError("region extends beyond the image");
  return provenance;
}

io::Metadata metadataOf(const Provenance& provenance) {
  io::Metadata metadata{{"Software", "quintet " + provenance.version}};
  for (const ProvenanceField& f : kFields) {
    if (f.metadataKey.empty()) continue;
    const FieldValue value = f.get(provenance);
    const bool* flag = std::get_if<bool>(&value);
    const double* number = std::get_if<double>(&value);
    std::string text = number ? fmt::format("{:.6g}", *number) : toText(value);
    if (text.empty() || (flag && !*flag)) continue;
    if (f.metadataKey == "Region" && !provenance.cropped()) continue;
    if (f.metadataKey == "DroppedSamples" && provenance.droppedSamples == 0) continue;
    if (f.metadataKey == "NotFinitePixels" && provenance.notFinitePixels == 0) continue;
    metadata.emplace_back(f.metadataKey, std::move(text));
  }
  return metadata;
}

}  // namespace quintet::job
