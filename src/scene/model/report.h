// SPDX-License-Identifier: Apache-2.0
// Report of an importer: what a scene file contains, and what the scene uses of it. `quintet info` prints it.
#ifndef QUINTET_SCENE_MODEL_REPORT_H
#define QUINTET_SCENE_MODEL_REPORT_H

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "scene/model/animation.h"

namespace quintet::scene {

enum class FeatureUse {
  used,      // as the file states it, or after a conversion without loss, which `reason` names
  unused,    // cannot change the image: not referenced by the scene, or without meaning for a path tracer
  repaired,  // used with a change
  ignored,   // can change the image, but is not supported or not valid
};

// A kind of content of a file, for example all attributes TEXCOORD_0 that are used.
struct Feature {
  std::string kind;  // "extension", "attribute", "texture", "node", …: docs/gltf.md lists them
  std::string name;  // "KHR_materials_ior", "TEXCOORD_0", the name of a camera; empty for objects without a name
  FeatureUse use = FeatureUse::used;
  std::size_t count = 0;  // number of occurrences
  std::string location;   // of the first one: a JSON pointer, after "NAME: " for a [[file]] of a scene file
  std::string reason;     // why it is unused or ignored, how it is repaired or converted; else empty
};

// Counts equal features: the same kind, name, use and reason.
class FeatureTable {
 public:
  void add(const std::string& kind, const std::string& name, const std::string& location,
           FeatureUse use = FeatureUse::used, const std::string& reason = {}, std::size_t count = 1);
  const std::vector<Feature>& features() const { return features_; }

 private:
  std::vector<Feature> features_;  // in the order of the first occurrences
  std::map<std::tuple<std::string, std::string, FeatureUse, std::string>, std::size_t> index_;
};

// A property of an XMP packet (KHR_xmp_json_ld).
struct MetadataEntry {
  std::string object;  // JSON pointers of the objects that refer to the packet; "/asset" means the whole file
  std::string name;    // "dc:title"; members of structures are separated by '/'
  std::string value;   // elements of lists are separated by ", "
};

struct Report {
  std::vector<std::string> extensionsUsed;     // used by the file and supported
  std::vector<std::string> extensionsIgnored;  // used by the file and not supported
  std::vector<Feature> features;               // everything that the file contains
  std::vector<std::string> ignored;            // "/meshes/0/primitives/2: mode LINES has no surface"
  std::vector<AnimationSummary> animations;    // of a glTF file, whether they play or not
  std::vector<KeyframeSummary> keyframes;      // of a scene file, in the order in which its tables are read
  std::size_t ignoredAnimations = 0;           // of glTF files, because none plays
  std::vector<std::string> repaired;           // "/meshes/0/primitives/0: 3 triangles with non-finite vertices dropped"
  std::string generator;                       // asset.generator
  std::string copyright;                       // asset.copyright
  std::vector<std::string> variants;           // names of the material variants of a glTF file
  std::vector<MetadataEntry> metadata;         // in the order of the file
  std::vector<std::filesystem::path> files;    // all files read: the scene file, glTF files, their buffers and images

  // Everything in the file has been used as the file states it.
  bool isExact() const { return ignored.empty() && repaired.empty(); }
};

const char* nameOf(FeatureUse);  // "used", "unused", "repaired", "ignored"

// Lines "LOCATION: REASON", with the number of occurrences, of the unused features that have a reason.
std::vector<std::string> unusedLines(const Report&);

// Throws FileError with all ignored and repaired parts unless report.isExact().
void requireExact(const std::filesystem::path& file, const Report& report);

// Replaces control characters from the file in all texts except the names of variants, which select them.
void makePrintable(Report&);

}  // namespace quintet::scene
#endif
