// SPDX-License-Identifier: Apache-2.0
#include "scene/gltf/variants.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "base/error.h"
#include "base/text.h"
#include "scene/gltf/extensions.h"

namespace quintet::scene {
namespace {

// Returns the material of the first mapping that names the variant, else the primitive's own.
int materialOf(const tinygltf::Primitive& primitive, int variant) {
  const tinygltf::Value* extension = findExtension(primitive.extensions, kVariants);
  if (!extension) return primitive.material;
  const tinygltf::Value& mappings = extension->Get("mappings");
  for (std::size_t i = 0; i < mappings.ArrayLen(); ++i) {
    const tinygltf::Value& mapping = mappings.Get(static_cast<int>(i));
    const tinygltf::Value& variants = mapping.Get("variants");
    for (std::size_t k = 0; k < variants.ArrayLen(); ++k)
      if (variants.Get(static_cast<int>(k)).GetNumberAsInt() == variant) return indexOf(mapping, "material");
  }
  return primitive.material;
}

}  // namespace

std::vector<std::string> variantNames(const Document& document) {
  std::vector<std::string> names;
  const tinygltf::Value* extension = findExtension(document.model.extensions, kVariants);
  if (!extension) return names;
  const tinygltf::Value& variants = extension->Get("variants");
  for (std::size_t i = 0; i < variants.ArrayLen(); ++i)
    names.push_back(stringOf(variants.Get(static_cast<int>(i)), "name", {}));
  return names;
}

void selectVariant(Document& document, const std::string& name) {
  const std::vector<std::string> names = variantNames(document);
  const auto found = std::ranges::find(names, name);
  if (found == names.end())
    throw UsageError(printable(
        names.empty()
            ? fmt::format("{}: no variant '{}': the file has no material variants", document.file.string(), name)
            : fmt::format("{}: no variant '{}'; available: {}", document.file.string(), name, fmt::join(names, ", "))));
  const auto variant = static_cast<int>(found - names.begin());
  for (tinygltf::Mesh& mesh : document.model.meshes)
    for (tinygltf::Primitive& primitive : mesh.primitives) primitive.material = materialOf(primitive, variant);
}

}  // namespace quintet::scene
