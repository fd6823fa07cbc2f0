// The one place where tinygltf's functions are compiled. CMakeLists.txt leaves files and images out of it.
#include <fstream>  // tinygltf 2.7.0 forgets it under TINYGLTF_NO_FS

#define TINYGLTF_IMPLEMENTATION
#include <tiny_gltf.h>
