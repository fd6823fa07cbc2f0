// A scene as the link sees it.
#ifndef QUINTET_RENDER_SCENE_FACTS_H
#define QUINTET_RENDER_SCENE_FACTS_H

#include "program/scene_facts.h"
#include "scene/scene.h"

namespace quintet::render {

// Geometries in the order of hit records: mesh by mesh, with those of meshes that no instance uses.
program::SceneFacts sceneFacts(const scene::Scene& scene);

}  // namespace quintet::render
#endif
