// SPDX-License-Identifier: Apache-2.0
// Unique names of instances, materials and lights, for Cryptomatte and tables. They depend only on the scene: an instance
// without a name takes that of its mesh, else "instance"; a material without a name is called "material", a light "light".
// A name that an earlier object has becomes the first of "name#2", "name#3", ... that no object has.
#ifndef QUINTET_SCENE_MODEL_NAMES_H
#define QUINTET_SCENE_MODEL_NAMES_H

#include <string>
#include <vector>

#include "scene/model/scene.h"

namespace quintet::scene {

// By index in Scene::instances.
std::vector<std::string> instanceNames(const Scene&);

// By index in Scene::materials, followed by the default material, "default", as on the device.
std::vector<std::string> materialNames(const Scene&);

// By index in Scene::lights.
std::vector<std::string> lightNames(const Scene&);

// The name of the scene; "scene in memory" if it has none, because it is not from a file.
std::string nameForMessages(const Scene&);

const char* nameOf(LightType);  // as in KHR_lights_punctual: "point", "spot", "directional"

}  // namespace quintet::scene
#endif
