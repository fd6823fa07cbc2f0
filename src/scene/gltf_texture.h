// Textures, samplers and images. Only what a material uses is loaded; images are decoded on all cores.
#ifndef QUINTET_SCENE_GLTF_TEXTURE_H
#define QUINTET_SCENE_GLTF_TEXTURE_H

#include <string>
#include <vector>

#include "scene/gltf_document.h"
#include "scene/memory_budget.h"

namespace quintet::scene {

class TextureTable {
 public:
  TextureTable(const Document&, Report&);

  // The index in Scene::textures of a texture of the file; kNone, with a line in the report, if it has no
  // image that can be read. `place` is the use.
  int use(int texture, const std::string& place);
  // Moves textures and samplers into the scene, and images as their headers describe them. False: some are in other files,
  // or broken, and are not described.
  bool describe(Scene&);
  // Decodes them: the last step, for it gives the memory of encoded images back as they are decoded. Throws FileError,
  // MemoryError.
  void decode(Scene&, MemoryBudget&);

 private:
  int useImage(int image);

  const Document& document_;
  Report& report_;
  std::vector<Texture> textures_;
  std::vector<int> textureOf_;     // file's texture → textures_
  std::vector<int> imageOf_;       // file's image → imageSources_
  std::vector<int> imageSources_;  // → file's image
};

}  // namespace quintet::scene
#endif
