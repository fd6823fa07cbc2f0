// SPDX-License-Identifier: Apache-2.0
// The properties of punctual lights that an interactive session can change, by name.
#ifndef QUINTET_JOB_INTERACTIVE_LIGHT_PROPERTIES_H
#define QUINTET_JOB_INTERACTIVE_LIGHT_PROPERTIES_H

#include <span>
#include <string>
#include <vector>

#include "scene/model/scene.h"

namespace quintet::job::interactive {

// "intensity": the largest component of scene::Light::intensity, ≥ 0; the color stays; that of a light of intensity 0
// is white.
// "color": the ratio of the components, ≥ 0 and not all 0; the intensity stays.
// "position": world space, meters; of point and spot lights.
// "direction": world space, any length but 0; of spot and directional lights.
// "innerConeAngle", "outerConeAngle": degrees, 0 to 90; of spot lights. scene::validateLight() checks that the inner
// one is not larger, so that an edit can set both in any order.
std::vector<std::string> lightProperties();
// Those that lights of this type have.
std::vector<std::string> lightProperties(scene::LightType type);

// A value that the light has already changes nothing, not even by rounding. Throws UsageError for an unknown name, a
// property that the type of light does not have, a wrong number of values, and a value out of range; then it changes
// nothing.
void setLightProperty(scene::Light& light, const std::string& name, std::span<const double> values);

// The same for a light of which `color` is the color at intensity 0: the intensity and the color can be set in any order.
void setLightProperty(scene::Light& light, vec3& color, const std::string& name, std::span<const double> values);

// Intensity and color as above; the largest component of the color is 1.
float lightIntensity(const scene::Light& light);
vec3 lightColor(const scene::Light& light);

}  // namespace quintet::job::interactive
#endif
