// SPDX-License-Identifier: Apache-2.0
#include "shader/library.h"

#include <fmt/format.h>

namespace quintet::shader {

Source passSource(const std::string& name) {
  Source source;
  source.stage = Stage::compute;
  source.name = name + ".comp";
  source.text = fmt::format("#version 460\n#include <quintet/passes/{}.glsl>\n", name);
  return source;
}

Hash libraryHash() {
  Hasher hasher;
  for (const EmbeddedFile& file : embeddedShaderLibrary()) hasher.add(file.path).add(file.data);
  return hasher.finish();
}

}  // namespace quintet::shader
