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
  // Decodes all images that were used and moves everything into the scene: the last step, for it gives the memory of
  // encoded images back as they are decoded. Throws FileError, MemoryError.
  void finish(Scene&, MemoryBudget&);

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
