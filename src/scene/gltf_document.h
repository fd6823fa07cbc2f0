// A glTF file that is checked as far as its JSON and its buffers go: every index exists, every number has
// its type, every buffer view lies inside its buffer, every accessor inside its view. tinygltf does the
// step from JSON to structs, on JSON that gltf_schema has reduced to what is known and valid; buffers and
// images are ours, because tinygltf reads them without bounds checks.
#ifndef QUINTET_SCENE_GLTF_DOCUMENT_H
#define QUINTET_SCENE_GLTF_DOCUMENT_H

#include <tiny_gltf.h>

#include <cstddef>
#include <deque>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/file.h"
#include "scene/scene.h"

namespace quintet::scene {

struct ImageSource {
  std::string name;  // the file's name for it, or empty
  std::string uri;   // empty: bufferView
  int bufferView = kNone;
};

struct Document {
  std::filesystem::path file;
  tinygltf::Model model;  // `buffers` and `images` stay empty
  std::vector<ImageSource> images;
  // Decompressed; parallel to model.bufferViews. data() is null for a view of a buffer that the file leaves
  // to its surroundings (no uri, no BIN chunk): legal as long as nobody reads it.
  std::vector<std::span<const std::byte>> bufferViews;
  std::size_t animationCount = 0;
  std::vector<std::filesystem::path> files;  // itself, and the files that its buffers and images name

  // What the spans point into. A deque: its elements stay where they are.
  std::deque<FileBytes> storage;

  [[noreturn]] void fail(std::string_view place, std::string_view problem) const;
  // The bytes of a view; throws FileError if there are none.
  std::span<const std::byte> view(int bufferView) const;
};

// Throws FileError.
Document readDocument(const std::filesystem::path& file);

// The container's parts (gltf_container.cpp): a GLB by its magic number, else the whole file is JSON.
struct Container {
  std::string_view json{};
  std::span<const std::byte> binary{};  // data() is null: no BIN chunk
  bool isGlb = false;
};
Container splitContainer(const std::filesystem::path& file, std::span<const std::byte> bytes);

// gltf_uri.cpp: the bytes behind a URI of the file: a data URI, or a relative path beside it.
FileBytes loadUri(const Document&, std::string_view uri, std::string_view place);
bool isDataUri(std::string_view uri);
std::filesystem::path pathOfUri(const Document&, std::string_view uri);  // of one that is no data URI
std::string percentDecode(std::string_view text);

}  // namespace quintet::scene
#endif
