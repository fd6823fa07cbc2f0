// SPDX-License-Identifier: Apache-2.0
// A glTF file as checked JSON and buffers. JSON goes through schema.cpp first; tinygltf then only turns valid JSON into
// structs. Buffers and images are read here, because tinygltf reads them without bounds checks. When the importer has
// called readDocument, resolveBufferViews and checkAccessors (accessor.h), every index is valid, every number has its
// type, every buffer view is inside its buffer and every accessor inside its view.
#ifndef QUINTET_SCENE_GLTF_DOCUMENT_H
#define QUINTET_SCENE_GLTF_DOCUMENT_H

#include <tiny_gltf.h>

#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "base/file.h"
#include "base/memory_budget.h"
#include "scene/gltf/schema.h"
#include "scene/model/scene.h"

namespace quintet::scene {

struct ImageSource {
  std::string name;  // images[i].name, or empty
  std::string uri;   // empty if the image is in bufferView
  int bufferView = kNone;
};

struct Buffer {
  std::uint64_t byteLength = 0;       // stated by the file
  std::span<const std::byte> data{};  // byteLength bytes; data() is null for a buffer without uri and BIN chunk
};

struct Document {
  std::filesystem::path file;
  bool allowExternal = false;  // LoadOptions::allowExternal
  std::shared_ptr<MemoryBudget> budget;
  tinygltf::Model model;  // `buffers` and `images` stay empty
  std::vector<ImageSource> images;
  std::vector<Buffer> buffers;
  // Parallel to model.bufferViews, decompressed. data() is null for a view of a buffer without data, which is valid as
  // long as nothing reads it.
  std::vector<std::span<const std::byte>> bufferViews;
  std::vector<MetadataEntry> metadata;
  std::vector<UnreadProperty> unread;                   // of the JSON
  std::map<std::string, ExtensionUse> extensionUses{};  // objects of supported extensions, by name
  std::vector<std::filesystem::path> files;             // this file, and the files that its buffers and images name

  // Owner of the bytes that the spans refer to. A deque, because its elements keep their addresses.
  std::deque<FileBytes> storage;

  // Throws FileError; `location` is a JSON pointer.
  [[noreturn]] void fail(std::string_view location, std::string_view problem, Remedy remedy = Remedy::none) const;
  // Bytes of a buffer view. Throws FileError if its buffer has no data.
  std::span<const std::byte> view(int bufferView) const;

  // Bytes of a data URI (RFC 2397), or of a file named by a relative path (RFC 3986). Throws FileError for any other
  // URI, and for a file outside of the folder unless allowExternal; nothing is fetched.
  FileBytes loadUri(std::string_view uri, std::string_view location) const;
  // The same for at most the first `count` bytes, which do not count in the budget.
  FileBytes loadBeginning(std::string_view uri, std::string_view location, std::size_t count) const;
  // The existing file of a URI that is not a data URI. Throws the FileErrors of loadUri without reading the file.
  std::filesystem::path fileOfUri(std::string_view uri, std::string_view location) const;
  // Path of a URI that is not a data URI: the decoded one, or if it does not exist the text itself, because some
  // exporters do not encode '%' in file names.
  std::filesystem::path pathOfUri(std::string_view uri) const;
};

bool isDataUri(std::string_view uri);
std::string percentDecode(std::string_view text);

// Reads the container, the JSON and the buffers; bufferViews stays empty. Throws FileError, MemoryError.
Document readDocument(const std::filesystem::path& file, bool allowExternal, std::shared_ptr<MemoryBudget> budget);

}  // namespace quintet::scene
#endif
