// SPDX-License-Identifier: Apache-2.0
#include "shader/library.h"

namespace quintet::shader {

Hash libraryHash() {
  Hasher hasher;
  for (const EmbeddedFile& file : embeddedShaderLibrary()) hasher.add(file.path).add(file.data);
  return hasher.finish();
}

}  // namespace quintet::shader
