// SPDX-License-Identifier: Apache-2.0
// Textures, samplers and images of a glTF file. Only images that a material uses are decoded, on all cores.
#ifndef QUINTET_SCENE_GLTF_TEXTURE_H
#define QUINTET_SCENE_GLTF_TEXTURE_H

#include <compare>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "base/memory_budget.h"
#include "scene/gltf/document.h"

namespace quintet::scene {

// An image of the scene and the image of the file that it is made of.
struct ImageUse {
  int image = kNone;  // index in Document::images
  // If set, the image is a specular-glossiness texture (KHR_materials_pbrSpecularGlossiness), and its colors become the
  // roughness: 1 - glossiness · alpha. Images without alpha have alpha 1.
  std::optional<float> glossiness{};
  auto operator<=>(const ImageUse&) const = default;
};

// Collects the textures that materials use.
class TextureTable {
 public:
  TextureTable(const Document&, Report&);

  // Index in textures() of a texture of the file, or kNone, with a line in the report, if the texture has no image in a
  // supported format. `location` is that of the use.
  // `glossiness`: see ImageUse.
  int use(int texture, const std::string& location, std::optional<float> glossiness = {});

  // Texture::image is an index into imageUses().
  const std::vector<Texture>& textures() const { return textures_; }
  const std::vector<ImageUse>& imageUses() const { return imageUses_; }
  // Whether a material uses the texture of the file.
  bool isUsed(int texture) const { return used_.contains(texture); }
  // Textures of the file that materials use, but that have no image in a supported format, with the reason.
  const std::map<int, std::string>& problems() const { return problems_; }

 private:
  int useImage(const ImageUse& use);
  // Image of a texture of the file: that of an extension if it can be read, else its own. kNone, with an entry in
  // problems_, without an image in a supported format.
  int chooseImage(int texture);

  const Document& document_;
  Report& report_;
  std::vector<Texture> textures_;
  std::vector<ImageUse> imageUses_;
  std::set<int> used_;  // textures of the file
  std::map<int, std::string> problems_;
  std::map<ImageUse, int> indexOfTexture_;  // ImageUse::image is here the index of a texture in the file
  std::map<ImageUse, int> indexOfImage_;    // in imageUses_, plus 1
};

// Sets the size, channels and type of each image from its header. Returns false if an image is in a separate file or
// has an invalid header; the images from that one on are then not described.
bool describeImages(const Document&, std::span<const ImageUse> uses, std::vector<NamedImage>& images);

// Decodes an image of the file. Throws FileError, MemoryError.
NamedImage loadImage(const Document&, std::size_t index, MemoryBudget&);

// An image that is missing or invalid.
struct ImageFailure {
  std::size_t use = 0;   // index of the use
  std::string location;  // JSON pointer
  std::string problem;   // one sentence without a period; empty if there is no failure
  Remedy remedy = Remedy::omitTextures;
};

// Decodes and converts the images. Returns the failures, in the order of the uses; their images are empty. Appends lines about
// images with values that cannot be used (limits.h) to `repaired`. Returns the
// memory of each encoded image to the system once the image is decoded; the images of the document must not be read
// afterwards. Throws MemoryError.
std::vector<ImageFailure> decodeImages(const Document&, std::span<const ImageUse> uses, std::vector<NamedImage>& images,
                                       std::vector<std::string>& repaired, MemoryBudget&);

// Repairs the values of an image of the file (limits.h). Returns the line for the report, or an empty text.
std::string repairImage(const Document&, int image, io::Image&);

// Materials no longer use the textures with this image of the scene, which becomes one white pixel. `glossiness`:
// ImageUse::glossiness of the image.
void removeTextures(Scene&, int image, std::optional<float> glossiness = {});

}  // namespace quintet::scene
#endif
