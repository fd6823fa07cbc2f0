// SPDX-License-Identifier: Apache-2.0
// Shaders that one SPIR-V module serves for all scenes: the features of a scene, which shaders/quintet/features.glsl declares,
// become specialization constants. The build compiles the built-in programs this way, and a compilation at run time then only
// sets the constants, which takes a sixth of the time.
#ifndef QUINTET_SHADER_SPECIALIZATION_H
#define QUINTET_SHADER_SPECIALIZATION_H

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/hash.h"
#include "shader/source.h"

namespace quintet::shader {

// Values of the specialization constants by constant_id: 0 or 1 for a bool, else the bits of the uint.
using FeatureValues = std::map<std::uint32_t, std::uint32_t>;

// A source whose definitions of features are replaced by QUINTET_SPECIALIZE.
struct GenericSource {
  Source source;
  FeatureValues values;  // of all constants; what the source did not define has the default of features.glsl
};

// Returns no value if `source` has definitions of features that differ from those of the renderer.
std::optional<GenericSource> makeGeneric(const Source& source);

// A module that the build has compiled.
struct ShippedModule {
  Hash key;  // of everything that decides its content
  std::vector<std::uint32_t> spirv;
};

// Returns the name of a module in CompilerOptions::shipped.
std::string shippedName(const Hash& key);

// Returns the module with this key; empty if it is not shipped.
std::vector<std::uint32_t> findShipped(std::span<const EmbeddedFile> shipped, const Hash& key);

}  // namespace quintet::shader
#endif
