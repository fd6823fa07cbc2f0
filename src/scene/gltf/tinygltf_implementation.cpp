// SPDX-License-Identifier: Apache-2.0
// The translation unit that compiles tinygltf. CMakeLists.txt disables its file and image functions.
#include <fstream>  // missing in tinygltf 2.7.0 under TINYGLTF_NO_FS

#define TINYGLTF_IMPLEMENTATION
#include <tiny_gltf.h>
