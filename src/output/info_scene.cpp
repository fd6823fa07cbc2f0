// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/plural.h"
#include "base/text.h"
#include "output/info.h"
#include "output/json_line.h"
#include "scene/load.h"
#include "scene/model/content_hash.h"
#include "scene/model/names.h"

namespace quintet::output {
namespace {

using Json = nlohmann::ordered_json;

std::size_t geometryCount(const scene::Scene& scene) {
  std::size_t count = 0;
  for (const scene::Mesh& mesh : scene.meshes) count += mesh.geometryCount();
  return count;
}

std::uint64_t imageBytes(const scene::Scene& scene) {
  std::uint64_t bytes = 0;
  for (const scene::NamedImage& image : scene.images) bytes += image.image.data.size();
  return bytes;
}

std::string describe(const scene::NamedImage& image) {
  constexpr const char* kChannelNames[] = {"", "gray", "gray + alpha", "RGB", "RGBA"};
  const io::Image& pixels = image.image;
  return fmt::format("{}: {}x{} {}, {} bits", printable(image.name), pixels.width, pixels.height,
                     kChannelNames[std::min(pixels.channels, 4u)], 8 * io::bytesPerSample(pixels.type));
}

std::string describe(const scene::Camera& camera) {
  const vec3 eye(camera.worldFromCamera[3]);
  const std::string lens = camera.orthographic
                               ? fmt::format("orthographic, {:.4g} x {:.4g} m", 2 * camera.orthographicHalfSize.x,
                                             2 * camera.orthographicHalfSize.y)
                               : fmt::format("perspective, {:.4g}°", glm::degrees(camera.verticalFov));
  const std::string aspect = camera.aspect > 0 ? fmt::format(", aspect {:.4g}", camera.aspect) : "";
  const std::string node = camera.nodeName.empty() || camera.nodeName == camera.name
                               ? ""
                               : fmt::format(" (node '{}')", printable(camera.nodeName));
  return fmt::format("'{}'{}: {}{}, at {:.4g} {:.4g} {:.4g}", printable(camera.name), node, lens, aspect, eye.x, eye.y,
                     eye.z);
}

std::string describe(const scene::Light& light) {
  return fmt::format("'{}': {}, {:.4g} {:.4g} {:.4g} {}", printable(light.name), scene::nameOf(light.type),
                     light.intensity.x, light.intensity.y, light.intensity.z,
                     light.type == scene::LightType::directional ? "W/m2" : "W/sr");
}

std::string describe(const scene::MetadataEntry& entry) {
  return printable(fmt::format("{}{}{}: {}", entry.object, entry.object.empty() ? "" : " ", entry.name, entry.value));
}

std::string describe(const scene::AnimationSummary& animation) {
  const std::string ignored = animation.ignored > 0 ? fmt::format(" ({} ignored)", animation.ignored) : "";
  return fmt::format("'{}': {:.4g} s, {}{}", printable(animation.name), animation.seconds,
                     counted(animation.channels, "channel"), ignored);
}

std::string joined(const std::vector<std::string>& names) {
  return names.empty() ? "none" : printable(fmt::format("{}", fmt::join(names, ", ")));
}

const char* nameOf(scene::Interpolation interpolation) {
  switch (interpolation) {
    case scene::Interpolation::step: return "step";
    case scene::Interpolation::linear: return "linear";
    case scene::Interpolation::cubicSpline: return "cubic";
  }
  return "";
}

std::string describe(const scene::KeyframeSummary& summary) {
  std::vector<std::string> keys;
  for (const auto& [name, interpolation] : summary.keys)
    keys.push_back(fmt::format("{} {}", name, nameOf(interpolation)));
  return fmt::format("{}: {} from {:.4g} to {:.4g} s: {}", printable(summary.object),
                     counted(summary.count, "keyframe"), summary.firstSeconds, summary.lastSeconds, joined(keys));
}

struct MaterialCounts {
  std::size_t alpha = 0, emissive = 0, transmissive = 0, unlit = 0;
};
MaterialCounts countMaterials(const scene::Scene& scene) {
  MaterialCounts counts;
  for (const scene::Material& material : scene.materials) {
    counts.alpha += material.alphaMode != scene::AlphaMode::opaque;
    counts.emissive += glm::any(glm::greaterThan(material.emissive, vec3(0.0f)));
    counts.transmissive += material.transmission > 0 || material.diffuseTransmission > 0;
    counts.unlit += material.unlit;
  }
  return counts;
}

// Numbers of instances that differ from the defaults, by property.
struct InstanceCounts {
  std::size_t procedural = 0, masked = 0, flagged = 0, indexed = 0, moving = 0;
};
InstanceCounts countInstances(const scene::Scene& scene) {
  InstanceCounts counts;
  for (const scene::Instance& instance : scene.instances) {
    counts.procedural += scene.meshes[static_cast<std::size_t>(instance.mesh)].procedural();
    counts.masked += instance.mask != 0xFF;
    counts.flagged += instance.flags != 0;
    counts.indexed += instance.customIndex != 0;
    counts.moving += instance.animated();
  }
  return counts;
}

std::string describe(const InstanceCounts& counts, std::size_t total) {
  std::string text;
  const auto add = [&](std::size_t count, const char* what) {
    if (count > 0) text += fmt::format("{}{} {}", text.empty() ? " (" : ", ", count, what);
  };
  add(counts.procedural, "procedural");
  add(counts.masked, "with a mask");
  add(counts.flagged, "with flags");
  add(counts.indexed, "with a custom index");
  add(counts.moving, "moving");
  return fmt::format("{}{}{}", total, text, text.empty() ? "" : ")");
}

Json vectorJson(const vec3& v) { return {v.x, v.y, v.z}; }

Json namedObjects(const scene::Scene& scene, const char* kind) {
  Json list = Json::array();
  if (kind == std::string_view("images"))
    for (const auto& [name, image] : scene.images)
      list.push_back({{"name", name},
                      {"width", image.width},
                      {"height", image.height},
                      {"channels", image.channels},
                      {"bits", 8 * io::bytesPerSample(image.type)}});
  if (kind == std::string_view("cameras"))
    for (const scene::Camera& camera : scene.cameras)
      list.push_back({{"name", camera.name},
                      {"node", camera.nodeName.empty() ? Json() : Json(camera.nodeName)},
                      {"type", camera.orthographic ? "orthographic" : "perspective"},
                      {"verticalFov", camera.orthographic ? Json() : Json(glm::degrees(camera.verticalFov))},
                      {"aspect", camera.aspect},
                      {"position", vectorJson(vec3(camera.worldFromCamera[3]))}});
  if (kind == std::string_view("animations"))
    for (const scene::AnimationSummary& animation : scene.report.animations)
      list.push_back({{"name", animation.name},
                      {"seconds", animation.seconds},
                      {"channels", animation.channels},
                      {"ignoredChannels", animation.ignored}});
  if (kind == std::string_view("keyframes"))
    for (const scene::KeyframeSummary& summary : scene.report.keyframes) {
      Json keys = Json::object();
      for (const auto& [name, interpolation] : summary.keys) keys[name] = nameOf(interpolation);
      list.push_back({{"object", summary.object},
                      {"count", summary.count},
                      {"firstSeconds", summary.firstSeconds},
                      {"lastSeconds", summary.lastSeconds},
                      {"keys", keys}});
    }
  if (kind == std::string_view("lights"))
    for (const scene::Light& light : scene.lights)
      list.push_back(
          {{"name", light.name}, {"type", scene::nameOf(light.type)}, {"intensity", vectorJson(light.intensity)}});
  return list;
}

Json featuresJson(const scene::Report& report) {
  Json list = Json::array();
  for (const scene::Feature& feature : report.features)
    list.push_back({{"kind", feature.kind},
                    {"name", feature.name},
                    {"use", nameOf(feature.use)},
                    {"count", feature.count},
                    {"location", feature.location},
                    {"reason", feature.reason}});
  return list;
}

Json metadataJson(const scene::Report& report) {
  Json list = Json::array();
  for (const scene::MetadataEntry& entry : report.metadata)
    list.push_back({{"object", entry.object}, {"name", entry.name}, {"value", entry.value}});
  return list;
}

Json toJson(const scene::Scene& scene, const std::string& file) {
  const Bounds3 bounds = scene::worldBounds(scene);
  const scene::TriangleCount triangles = scene::countTriangles(scene);
  const scene::ProceduralCount procedural = scene::countProcedural(scene);
  const InstanceCounts instances = countInstances(scene);
  const MaterialCounts materials = countMaterials(scene);
  return {{"file", file},
          {"kind", "scene"},
          {"hash", scene::contentHash(scene).hex()},
          {"generator", scene.report.generator},
          {"copyright", scene.report.copyright},
          {"bounds", bounds.empty() ? Json() : Json{{"min", vectorJson(bounds.min)}, {"max", vectorJson(bounds.max)}}},
          {"meshes", scene.meshes.size()},
          {"geometries", geometryCount(scene)},
          {"triangles", {{"stored", triangles.stored}, {"instanced", triangles.instanced}}},
          {"procedural",
           {{"sets", procedural.sets},
            {"solids", procedural.solids},
            {"trees", procedural.csgTrees},
            {"leaves", procedural.csgLeaves},
            {"customBoxes", procedural.customBoxes}}},
          {"instances", scene.instances.size()},
          {"instancesWith",
           {{"mask", instances.masked},
            {"flags", instances.flagged},
            {"customIndex", instances.indexed},
            {"keyframes", instances.moving},
            {"procedural", instances.procedural}}},
          {"materials",
           {{"count", scene.materials.size()},
            {"alpha", materials.alpha},
            {"emissive", materials.emissive},
            {"transmissive", materials.transmissive},
            {"unlit", materials.unlit}}},
          {"variants", scene.report.variants},
          {"textures", scene.textures.size()},
          {"imageBytes", imageBytes(scene)},
          {"images", namedObjects(scene, "images")},
          {"lights", namedObjects(scene, "lights")},
          {"cameras", namedObjects(scene, "cameras")},
          {"animations", namedObjects(scene, "animations")},
          {"keyframes", namedObjects(scene, "keyframes")},
          {"environment", scene.environment.present},
          {"extensions", {{"used", scene.report.extensionsUsed}, {"ignored", scene.report.extensionsIgnored}}},
          {"metadata", metadataJson(scene.report)},
          {"features", featuresJson(scene.report)},
          {"ignored", scene.report.ignored},
          {"repaired", scene.report.repaired}};
}

// "label  head" and one indented line for each element.
template <class List, class Describe>
void addList(std::string& text, const char* label, const std::string& head, const List& list, Describe&& describeOne) {
  text += fmt::format("   {:<12}{}\n", label, head);
  std::size_t index = 0;
  for (const auto& element : list) text += fmt::format("   {:<12}  {} {}\n", "", index++, describeOne(element));
}

// "LOCATION: NAME CONVERSION" for each extension whose values are stored in a different form.
std::vector<std::string> convertedLines(const scene::Report& report) {
  std::vector<std::string> lines;
  for (const scene::Feature& feature : report.features)
    if (feature.use == scene::FeatureUse::used && !feature.reason.empty())
      lines.push_back(fmt::format("{}: {} {}", feature.location, feature.name, feature.reason));
  return lines;
}

// Lines such as "attributes  used: NORMAL (2), POSITION (2)" and "textures  used: 5" for each kind.
std::string featuresText(const scene::Report& report) {
  // Kinds whose names are defined by glTF; the names of other objects are arbitrary, and only counted.
  constexpr std::string_view kNamedKinds[] = {"extension", "node", "primitive", "attribute", "morph target"};
  constexpr scene::FeatureUse kUses[] = {scene::FeatureUse::used, scene::FeatureUse::unused,
                                         scene::FeatureUse::repaired, scene::FeatureUse::ignored};
  std::vector<std::string> kinds;
  for (const scene::Feature& feature : report.features)
    if (std::ranges::find(kinds, feature.kind) == kinds.end()) kinds.push_back(feature.kind);
  std::string text;
  for (const std::string& kind : kinds) {
    const bool named = std::ranges::find(kNamedKinds, kind) != std::end(kNamedKinds);
    std::string label = kind + (kind.ends_with("property") ? "" : "s");
    if (kind == "property") label = "properties";
    for (const scene::FeatureUse use : kUses) {
      std::map<std::string, std::size_t> counts;
      for (const scene::Feature& feature : report.features)
        if (feature.kind == kind && feature.use == use) counts[named ? feature.name : ""] += feature.count;
      if (counts.empty()) continue;
      std::vector<std::string> parts;
      for (const auto& [name, count] : counts)
        parts.push_back(named ? fmt::format("{} ({})", printable(name), count) : std::to_string(count));
      text += fmt::format("   {:<14}{}: {}\n", label, nameOf(use), fmt::join(parts, ", "));
      label.clear();
    }
  }
  return text;
}

std::string toText(const scene::Scene& scene, const std::string& file) {
  const Bounds3 bounds = scene::worldBounds(scene);
  const scene::TriangleCount triangles = scene::countTriangles(scene);
  const MaterialCounts materials = countMaterials(scene);
  const auto describeAny = [](const auto& element) { return describe(element); };
  const auto itself = [](const std::string& line) { return printable(line); };
  std::string text = fmt::format("{}: {}\n", printable(file),
                                 scene::sceneFormat(file, {}) == scene::SceneFormat::toml ? "scene" : "glTF scene");
  const auto line = [&text](const char* label, const std::string& value) {
    if (!value.empty()) text += fmt::format("   {:<12}{}\n", label, value);
  };
  line("generator", printable(scene.report.generator));
  line("copyright", printable(scene.report.copyright));
  if (!scene.report.metadata.empty())
    addList(text, "metadata", fmt::format("{}", scene.report.metadata.size()), scene.report.metadata, describeAny);
  line("hash", scene::contentHash(scene).hex());
  if (bounds.empty()) {
    line("bounds", "empty");
  } else {
    const vec3 size = bounds.extent();
    line("bounds",
         fmt::format("{:.4g} {:.4g} {:.4g} to {:.4g} {:.4g} {:.4g} ({:.4g} x {:.4g} x {:.4g} m)", bounds.min.x,
                     bounds.min.y, bounds.min.z, bounds.max.x, bounds.max.y, bounds.max.z, size.x, size.y, size.z));
  }
  line("meshes",
       fmt::format("{} with {}", scene.meshes.size(), counted(geometryCount(scene), "geometry", "geometries")));
  line("triangles", fmt::format("{} stored, {} in instances", triangles.stored, triangles.instanced));
  const scene::ProceduralCount procedural = scene::countProcedural(scene);
  if (procedural.sets > 0)
    line("procedural",
         fmt::format("{}: {}, {} of {}, {}", counted(procedural.sets, "set"), counted(procedural.solids, "solid"),
                     counted(procedural.csgTrees, "tree"), counted(procedural.csgLeaves, "leaf", "leaves"),
                     counted(procedural.customBoxes, "custom box", "custom boxes")));
  line("instances", describe(countInstances(scene), scene.instances.size()));
  line("materials", fmt::format("{} ({} with alpha, {} emissive, {} transmissive, {} unlit)", scene.materials.size(),
                                materials.alpha, materials.emissive, materials.transmissive, materials.unlit));
  if (!scene.report.variants.empty()) line("variants", joined(scene.report.variants));
  line("textures", fmt::format("{}", scene.textures.size()));
  addList(text, "images", fmt::format("{}, {} decoded", scene.images.size(), bytesText(imageBytes(scene))),
          scene.images, describeAny);
  addList(text, "lights", fmt::format("{}", scene.lights.size()), scene.lights, describeAny);
  addList(text, "cameras", fmt::format("{}", scene.cameras.size()), scene.cameras, describeAny);
  addList(text, "animations", fmt::format("{}", scene.report.animations.size()), scene.report.animations, describeAny);
  if (!scene.report.keyframes.empty())
    addList(text, "keyframes", fmt::format("{}", scene.report.keyframes.size()), scene.report.keyframes, describeAny);
  text += featuresText(scene.report);
  const std::vector<std::string> converted = convertedLines(scene.report);
  if (!converted.empty()) addList(text, "converted", fmt::format("{}", converted.size()), converted, itself);
  const std::vector<std::string> unused = unusedLines(scene.report);
  addList(text, "unused", fmt::format("{}", unused.size()), unused, itself);
  addList(text, "ignored", fmt::format("{}", scene.report.ignored.size()), scene.report.ignored, itself);
  addList(text, "repaired", fmt::format("{}", scene.report.repaired.size()), scene.report.repaired, itself);
  return text;
}

}  // namespace

std::string sceneInfo(const std::filesystem::path& file, bool json, const scene::LoadOptions& options) {
  const scene::Scene scene = scene::loadScene(file, options);
  if (!json) return toText(scene, file.string());
  return jsonLine(toJson(scene, file.string()));
}

}  // namespace quintet::output
