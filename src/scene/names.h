// Names for the things of a scene, one each, for mattes (Cryptomatte) and tables. The rule, which depends on the scene
// alone: a thing keeps its name; an instance without one takes its mesh's, else "instance"; a material without one is
// "material". Where a name is taken already, the later thing gets "name#2", "name#3", ... : the first that is free.
#ifndef QUINTET_SCENE_NAMES_H
#define QUINTET_SCENE_NAMES_H

#include <string>
#include <vector>

#include "scene/scene.h"

namespace quintet::scene {

// By index in Scene::instances.
std::vector<std::string> instanceNames(const Scene&);

// By index in Scene::materials; then, as on the device, that of the default material: "default".
std::vector<std::string> materialNames(const Scene&);

}  // namespace quintet::scene
#endif
