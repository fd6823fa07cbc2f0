// SPDX-License-Identifier: Apache-2.0
// Textures, samplers and images of a glTF file. Only images that a material uses are decoded, on all cores.
#ifndef QUINTET_SCENE_GLTF_TEXTURE_H
#define QUINTET_SCENE_GLTF_TEXTURE_H

#include <span>
#include <string>
#include <vector>

#include "scene/gltf/document.h"
#include "scene/memory_budget.h"

namespace quintet::scene {

// Collects the textures that materials use.
class TextureTable {
 public:
  TextureTable(const Document&, Report&);

  // Index in textures() of a texture of the file, or kNone, with a line in the report, if the texture has no image in a
  // supported format. `location` is that of the use.
  int use(int texture, const std::string& location);

  // Texture::image is an index into imageSources().
  const std::vector<Texture>& textures() const { return textures_; }
  // Indices into Document::images.
  const std::vector<int>& imageSources() const { return imageSources_; }

 private:
  int useImage(int image);

  const Document& document_;
  Report& report_;
  std::vector<Texture> textures_;
  std::vector<int> imageSources_;
  std::vector<int> textureOf_;  // index in the file → index in textures_, or kNone
  std::vector<int> imageOf_;    // index in the file → index in imageSources_, or kNone
};

// Sets the size, channels and type of each image from its header. Returns false if an image is in a separate file or
// has an invalid header; the images from that one on are then not described.
bool describeImages(const Document&, std::span<const int> imageSources, std::vector<NamedImage>& images);

// Decodes the images. Returns the memory of each encoded image to the system once the image is decoded; the images of
// the document must not be read afterwards. Throws FileError, MemoryError.
void decodeImages(const Document&, std::span<const int> imageSources, std::vector<NamedImage>& images, MemoryBudget&);

}  // namespace quintet::scene
#endif
