// SPDX-License-Identifier: Apache-2.0
#include "scene/gltf/inventory.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <set>

#include "base/plural.h"
#include "scene/gltf/extensions.h"
#include "scene/model/material_textures.h"

namespace quintet::scene {
namespace {

// Extensions whose values are stored in a different form without loss.
struct Conversion {
  std::string_view extension;
  const char* text;
};
constexpr Conversion kConversions[] = {
    {"KHR_materials_pbrSpecularGlossiness", "converted to a dielectric whose reflectance is the specular color"}};

const char* conversionOf(std::string_view extension) {
  const auto found = std::ranges::find(kConversions, extension, &Conversion::extension);
  return found == std::end(kConversions) ? "" : found->text;
}

constexpr const char* kNotInScene = "no visible node of the scene has it";
constexpr const char* kModeNames[] = {"POINTS",    "LINES",          "LINE_LOOP",   "LINE_STRIP",
                                      "TRIANGLES", "TRIANGLE_STRIP", "TRIANGLE_FAN"};

// Lines of the report by their location.
class Lines {
 public:
  explicit Lines(const std::vector<std::string>& lines) {
    for (const std::string& line : lines) {
      const std::size_t end = std::min(line.find(": "), line.size());
      texts_.emplace(line.substr(0, end), line.substr(std::min(end + 2, line.size())));
    }
  }
  const std::string* at(const std::string& location) const {
    const auto found = texts_.find(location);
    return found == texts_.end() ? nullptr : &found->second;
  }
  // Also inside of the object at the location.
  const std::string* within(const std::string& location) const {
    if (const std::string* text = at(location)) return text;
    const auto next = texts_.lower_bound(location + "/");
    return next != texts_.end() && next->first.starts_with(location + "/") ? &next->second : nullptr;
  }

 private:
  std::multimap<std::string, std::string> texts_;
};

std::string imageName(const Document& document, int image) {
  const ImageSource& source = document.images[static_cast<std::size_t>(image)];
  if (!source.name.empty()) return source.name;
  return isDataUri(source.uri) ? std::string() : percentDecode(source.uri);
}

// Bit i: a texture of the material uses TEXCOORD_i.
unsigned usedUvSets(const Material& material) {
  unsigned sets = 0;
  for (const MaterialTexture& texture : kMaterialTextures)
    if (const TextureUse& use = material.*texture.use; use.used()) sets |= 1u << use.uvSet;
  return sets;
}

class Inventory {
 public:
  Inventory(const Document& document, const NodeTree& tree, const TextureTable& textures, const PlayedAnimation& played,
            const std::vector<Material>& materials, const ImageBasedLight& imageLight, Report& report)
      : document_(document),
        model_(document.model),
        tree_(tree),
        textures_(textures),
        played_(played),
        imageLight_(imageLight),
        report_(report) {
    for (const Material& material : materials) uvSets_.push_back(usedUvSets(material));
  }

  void list() {
    findUses();
    addNewLines();
    const Lines ignored(report_.ignored), repaired(report_.repaired);
    ignored_ = &ignored;
    repaired_ = &repaired;
    listExtensions();
    listNodes();
    listMeshes();
    listObjects("material", model_.materials, materials_, "no mesh of the scene has it");
    listTextures();
    listObjects("skin", model_.skins, skins_, kNotInScene);
    listAnimations();
    listObjects("camera", model_.cameras, cameras_, kNotInScene);
    listLights();
    listProperties();
    report_.features = table_.features();
  }

 private:
  // ---- What the scene refers to ----

  void findUses() {
    for (const int index : tree_.sceneNodes) {
      const tinygltf::Node& node = model_.nodes[static_cast<std::size_t>(index)];
      nodes_.insert(index);
      cameras_.insert(node.camera);
      if (!isShown(index)) continue;
      meshes_.insert(node.mesh);
      skins_.insert(node.skin);
      if (node.mesh != kNone && node.skin != kNone) skinnedMeshes_.insert(node.mesh);
      if (const tinygltf::Value* light = findExtension(node.extensions, kPunctualLights))
        lights_.insert(indexOf(*light, "light"));
    }
    for (const tinygltf::Skin& skin : model_.skins) joints_.insert(skin.joints.begin(), skin.joints.end());
    for (const int mesh : meshes_)
      if (mesh != kNone)
        for (const tinygltf::Primitive& primitive : model_.meshes[static_cast<std::size_t>(mesh)].primitives)
          materials_.insert(primitive.material);
  }

  // ---- Lines for what no reader saw ----

  void ignore(const std::string& location, const std::string& text) {
    report_.ignored.push_back(fmt::format("{}: {}", location, text));
  }

  void addNewLines() {
    for (const UnreadProperty& property : document_.unread)
      if (property.cause == UnreadProperty::Cause::unknown)
        ignore(property.location,
               "unknown property" + (property.count > 1 ? fmt::format(" ({} times)", property.count) : ""));
    addExtensionLines();
    for (std::size_t i = 0; i < model_.meshes.size(); ++i)
      for (std::size_t k = 0; k < model_.meshes[i].primitives.size(); ++k)
        addPrimitiveLines(model_.meshes[i].primitives[k], fmt::format("/meshes/{}/primitives/{}", i, k));
    for (const int index : tree_.sceneNodes)
      if (isShown(index)) addInstancingLines(index);
  }

  // One line for each extension that is not supported.
  void addExtensionLines() {
    for (const UnreadProperty& property : document_.unread) {
      if (property.cause != UnreadProperty::Cause::extension || hasNoEffect(property.name)) continue;
      ExtensionUse& use = unsupported_[property.name];
      if (use.count == 0) use.location = property.location;
      use.count += property.count;
    }
    for (const auto& [name, use] : unsupported_)
      ignore(use.location,
             fmt::format("extension {}{}", isSupportedExtension(name) ? "not defined for this object" : "not supported",
                         use.count > 1 ? fmt::format(" ({} objects)", use.count) : ""));
    for (std::size_t i = 0; i < model_.extensionsUsed.size(); ++i) {
      const std::string& name = model_.extensionsUsed[i];
      if (!isSupportedExtension(name) && !hasNoEffect(name) && !unsupported_.contains(name))
        ignore(fmt::format("/extensionsUsed/{}", i), fmt::format("extension {} not supported", name));
    }
  }

  void addPrimitiveLines(const tinygltf::Primitive& primitive, const std::string& location) {
    for (std::size_t i = 0; i < primitive.targets.size(); ++i)
      for (const auto& [name, accessor] : primitive.targets[i])
        if (name != "POSITION" && name != "NORMAL" && name != "TANGENT" && !name.starts_with('_'))
          ignore(fmt::format("{}/targets/{}/{}", location, i, name), "attribute of a morph target not supported");
    const auto positions = primitive.attributes.find("POSITION");
    if (primitive.mode != TINYGLTF_MODE_TRIANGLES || positions == primitive.attributes.end()) return;
    const int counted = primitive.indices == kNone ? positions->second : primitive.indices;
    const std::size_t rest = model_.accessors[static_cast<std::size_t>(counted)].count % 3;
    if (rest > 0 && !primitive.extensions.contains(kDraco))
      report_.repaired.push_back(fmt::format("{}: {} after the last whole triangle dropped", location,
                                             quintet::counted(rest, "index", "indices")));
  }

  void addInstancingLines(int index) {
    const tinygltf::Node& node = model_.nodes[static_cast<std::size_t>(index)];
    const tinygltf::Value* instancing = findExtension(node.extensions, kInstancing);
    if (!instancing) return;
    const std::string location = fmt::format("/nodes/{}/extensions/{}", index, kInstancing);
    if (node.mesh == kNone) ignore(location, "the node has no mesh");
    if (node.mesh != kNone && node.skin != kNone) ignore(location, "instances of a skinned mesh are not supported");
    for (const std::string& name : instancing->Get("attributes").Keys())
      if (name != "TRANSLATION" && name != "ROTATION" && name != "SCALE" && !name.starts_with('_'))
        ignore(fmt::format("{}/attributes/{}", location, name), "attribute of instances not supported");
  }

  // ---- Features ----

  // Adds an object. A line about it decides first, else `unusedReason`, if there is one.
  void add(const std::string& kind, const std::string& name, const std::string& location,
           const std::string& unusedReason = {}) {
    if (const std::string* text = ignored_->at(location))
      table_.add(kind, name, location, FeatureUse::ignored, *text);
    else if (!unusedReason.empty())
      table_.add(kind, name, location, FeatureUse::unused, unusedReason);
    else if (const std::string* repair = repaired_->within(location))
      table_.add(kind, name, location, FeatureUse::repaired, *repair);
    else
      table_.add(kind, name, location);
  }

  template <class Object>
  void listObjects(const std::string& kind, const std::vector<Object>& objects, const std::set<int>& used,
                   const char* unusedReason) {
    for (std::size_t i = 0; i < objects.size(); ++i)
      add(kind, objects[i].name, fmt::format("/{}s/{}", kind, i),
          used.contains(static_cast<int>(i)) ? "" : unusedReason);
  }

  void listExtensions() {
    std::set<std::string> seen;
    for (std::size_t i = 0; i < model_.extensionsUsed.size(); ++i) {
      const std::string& name = model_.extensionsUsed[i];
      if (seen.insert(name).second) listExtension(name, fmt::format("/extensionsUsed/{}", i));
    }
    for (const auto& [name, use] : document_.extensionUses)
      if (seen.insert(name).second) listExtension(name, use.location);
    for (const auto& [name, use] : unsupported_)
      if (seen.insert(name).second) listExtension(name, use.location);
  }

  void listExtension(const std::string& name, const std::string& location) {
    const auto used = document_.extensionUses.find(name);
    const auto unsupported = unsupported_.find(name);
    if (unsupported != unsupported_.end())
      table_.add("extension", name, unsupported->second.location, FeatureUse::ignored,
                 *ignored_->at(unsupported->second.location), unsupported->second.count);
    if (used != document_.extensionUses.end())
      table_.add("extension", name, used->second.location, FeatureUse::used, conversionOf(name), used->second.count);
    else if (hasNoEffect(name))
      table_.add("extension", name, location, FeatureUse::unused, "metadata");
    else if (isSupportedExtension(name) && name != kQuantization)
      table_.add("extension", name, location, FeatureUse::unused, "no object has it");
    else if (unsupported == unsupported_.end())
      add("extension", name, location);
  }

  // The parts of nodes: "mesh", "camera", …
  void listNodes() {
    for (std::size_t i = 0; i < model_.scenes.size(); ++i)
      add("scene", model_.scenes[i].name, fmt::format("/scenes/{}", i),
          static_cast<int>(i) == tree_.scene ? "" : "a different scene of the file is selected");
    for (std::size_t i = 0; i < model_.nodes.size(); ++i) {
      const tinygltf::Node& node = model_.nodes[i];
      const std::string location = fmt::format("/nodes/{}", i);
      if (!nodes_.contains(static_cast<int>(i))) {
        add("node", joints_.contains(static_cast<int>(i)) ? "joint" : "other", location,
            joints_.contains(static_cast<int>(i)) ? "" : "the node is not in the scene");
        continue;
      }
      const auto part = [&](bool exists, const char* name, const std::string& inside) {
        const bool shown = isShown(static_cast<int>(i)) || std::string_view(name) == "camera" || inside.empty();
        if (exists) add("node", name, location + inside, shown ? "" : "the node is hidden");
      };
      part(true, "transform", "");
      if (!node.matrix.empty() && !(node.translation.empty() && node.rotation.empty() && node.scale.empty()))
        add("node", "translation, rotation, scale", location, "the matrix of the node has precedence");
      if (node.extensions.contains(kVisibility))
        add("node", "visibility", fmt::format("{}/extensions/{}", location, kVisibility));
      part(node.mesh != kNone, "mesh", "/mesh");
      part(node.skin != kNone, "skin", "/skin");
      part(node.camera != kNone, "camera", "/camera");
      part(!node.weights.empty(), "morph weights", "/weights");
      part(node.extensions.contains(kPunctualLights), "light", fmt::format("/extensions/{}", kPunctualLights));
      part(node.extensions.contains(kInstancing), "instances", fmt::format("/extensions/{}", kInstancing));
    }
  }

  void listMeshes() {
    for (std::size_t i = 0; i < model_.meshes.size(); ++i) {
      const bool used = meshes_.contains(static_cast<int>(i));
      for (std::size_t k = 0; k < model_.meshes[i].primitives.size(); ++k)
        listPrimitive(static_cast<int>(i), model_.meshes[i].primitives[k],
                      fmt::format("/meshes/{}/primitives/{}", i, k), used ? "" : kNotInScene);
    }
  }

  void listPrimitive(int mesh, const tinygltf::Primitive& primitive, const std::string& location,
                     const std::string& unusedReason) {
    add("primitive", kModeNames[primitive.mode], location, unusedReason);
    const std::string* ignored = ignored_->at(location);
    for (const auto& [name, accessor] : primitive.attributes) {
      const std::string inside = fmt::format("{}/attributes/{}", location, name);
      if (ignored)
        table_.add("attribute", name, inside, FeatureUse::ignored, *ignored);
      else
        add("attribute", name, inside, unusedReason.empty() ? unusedAttribute(mesh, primitive, name) : unusedReason);
    }
    for (std::size_t i = 0; i < primitive.targets.size(); ++i)
      for (const auto& [name, accessor] : primitive.targets[i])
        add("morph target", name, fmt::format("{}/targets/{}/{}", location, i, name),
            name.starts_with('_') ? "application-specific attribute" : unusedReason);
  }

  // Why the attribute cannot change the image; empty if it can.
  std::string unusedAttribute(int mesh, const tinygltf::Primitive& primitive, const std::string& name) const {
    if (name.starts_with('_')) return "application-specific attribute";
    if ((name.starts_with("JOINTS_") || name.starts_with("WEIGHTS_")) && !skinnedMeshes_.contains(mesh))
      return "no node with the mesh has a skin";
    if (name == "TANGENT" && !primitive.attributes.contains("NORMAL"))
      return "the primitive has no normals (glTF 2.0, section 3.7.2.1)";
    for (unsigned set = 0; set < kMaxUvSets; ++set)
      if (name == fmt::format("TEXCOORD_{}", set) &&
          (primitive.material == kNone || !(uvSets_[static_cast<std::size_t>(primitive.material)] >> set & 1)))
        return "no texture of the material uses it";
    return {};
  }

  void listTextures() {
    std::set<int> images;
    for (std::size_t i = 0; i < model_.textures.size(); ++i) {
      const std::string location = fmt::format("/textures/{}", i);
      const auto index = static_cast<int>(i);
      if (const auto line = textures_.problems().find(index); line != textures_.problems().end())
        table_.add("texture", model_.textures[i].name, location, FeatureUse::ignored, line->second);
      else
        add("texture", model_.textures[i].name, location, textures_.isUsed(index) ? "" : "no material uses it");
    }
    for (const ImageUse& use : textures_.imageUses()) images.insert(use.image);
    images.insert(imageLight_.images.begin(), imageLight_.images.end());
    for (std::size_t i = 0; i < document_.images.size(); ++i)
      add("image", imageName(document_, static_cast<int>(i)), fmt::format("/images/{}", i),
          images.contains(static_cast<int>(i))                    ? ""
          : imageLight_.prefiltered.contains(static_cast<int>(i)) ? "only level 0 of an image-based light is used"
                                                                  : "no texture that a material uses has it");
  }

  // At any time.
  bool isShown(int node) const { return tree_.visible[static_cast<std::size_t>(node)] || played_.togglesNode(node); }

  void listAnimations() {
    const char* const unusedReason = played_.data ? "another animation plays" : "no animation plays";
    for (std::size_t i = 0; i < model_.animations.size(); ++i) {
      const std::string location = fmt::format("/animations/{}", i);
      add("animation", model_.animations[i].name, location, static_cast<int>(i) == played_.index ? "" : unusedReason);
      for (std::size_t k = 0; k < model_.animations[i].channels.size(); ++k) {
        const std::string target = fmt::format("{}/channels/{}/target", location, k);
        if (const std::string* text = ignored_->within(target))
          table_.add("animation channel", model_.animations[i].channels[k].target_path, target, FeatureUse::ignored,
                     *text);
      }
    }
  }

  void listLights() {
    for (std::size_t i = 0; i < model_.lights.size(); ++i)
      add("light", model_.lights[i].name, fmt::format("/extensions/{}/lights/{}", kPunctualLights, i),
          lights_.contains(static_cast<int>(i)) ? "" : kNotInScene);
    const tinygltf::Value* imageLights = findExtension(model_.extensions, kImageBasedLights);
    const std::size_t count = imageLights ? imageLights->Get("lights").ArrayLen() : 0;
    for (std::size_t i = 0; i < count; ++i)
      add("light", stringOf(imageLights->Get("lights").Get(static_cast<int>(i)), "name", ""),
          fmt::format("/extensions/{}/lights/{}", kImageBasedLights, i),
          imageLight_.light == static_cast<int>(i) ? "" : "the scene does not have it");
  }

  void listProperties() {
    for (const UnreadProperty& property : document_.unread) {
      if (property.cause == UnreadProperty::Cause::noEffect)
        table_.add("property", property.name, property.location, FeatureUse::unused, property.reason, property.count);
      if (property.cause == UnreadProperty::Cause::unknown)
        table_.add("property", property.name, property.location, FeatureUse::ignored, "unknown property",
                   property.count);
    }
  }

  const Document& document_;
  const tinygltf::Model& model_;
  const NodeTree& tree_;
  const TextureTable& textures_;
  const PlayedAnimation& played_;
  const ImageBasedLight& imageLight_;
  Report& report_;
  std::vector<unsigned> uvSets_;                                                                  // of each material
  std::set<int> nodes_, meshes_, skinnedMeshes_, materials_, skins_, cameras_, lights_, joints_;  // used by the scene
  std::map<std::string, ExtensionUse> unsupported_;
  const Lines* ignored_ = nullptr;
  const Lines* repaired_ = nullptr;
  FeatureTable table_;
};

}  // namespace

void completeReport(const Document& document, const NodeTree& tree, const TextureTable& textures,
                    const PlayedAnimation& played, const std::vector<Material>& materials,
                    const ImageBasedLight& imageLight, Report& report) {
  Inventory(document, tree, textures, played, materials, imageLight, report).list();
}

void reportMissingImages(const Document& document, const std::vector<MissingImage>& missing, Report& report) {
  FeatureTable table;
  for (const MissingImage& image : missing) {
    const std::string name = imageName(document, image.image), location = fmt::format("/images/{}", image.image);
    report.ignored.push_back(fmt::format("{}: {}; rendered without its textures", location, image.problem));
    const auto used = std::ranges::find_if(report.features, [&](const Feature& feature) {
      return feature.kind == "image" && feature.name == name && feature.use == FeatureUse::used;
    });
    if (used != report.features.end() && --used->count == 0) report.features.erase(used);
    table.add("image", name, location, FeatureUse::ignored, image.problem);
  }
  report.features.insert(report.features.end(), table.features().begin(), table.features().end());
}

}  // namespace quintet::scene
