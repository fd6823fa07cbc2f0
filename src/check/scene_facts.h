// SPDX-License-Identifier: Apache-2.0
// The facts of a scene on which the rules depend.
#ifndef QUINTET_CHECK_SCENE_FACTS_H
#define QUINTET_CHECK_SCENE_FACTS_H

#include "program/scene_facts.h"
#include "scene/model/scene.h"

namespace quintet::check {

// Geometries are in the order of hit records: by mesh, including meshes without instances.
program::SceneFacts sceneFacts(const scene::Scene& scene);

}  // namespace quintet::check
#endif
