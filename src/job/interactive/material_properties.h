// SPDX-License-Identifier: Apache-2.0
// The properties of materials that an interactive session can change, by name.
#ifndef QUINTET_JOB_INTERACTIVE_MATERIAL_PROPERTIES_H
#define QUINTET_JOB_INTERACTIVE_MATERIAL_PROPERTIES_H

#include <span>
#include <string>
#include <vector>

#include "scene/model/scene.h"

namespace quintet::job::interactive {

// As the members of scene::Material: "baseColor", "roughness", … without textures.
std::vector<std::string> materialProperties();

// Throws UsageError for an unknown name or a wrong number of values. A base color of three values keeps its alpha.
// Ranges are those of scene::validateMaterial().
void setMaterialProperty(scene::Material& material, const std::string& name, std::span<const double> values);

// The values that setMaterialProperty() sets; a base color has four. Throws UsageError for an unknown name.
std::vector<double> materialPropertyValue(const scene::Material& material, const std::string& name);

}  // namespace quintet::job::interactive
#endif
