// SPDX-License-Identifier: Apache-2.0
// What a user must know about a scene before it is rendered.
#ifndef QUINTET_JOB_SCENE_NOTES_H
#define QUINTET_JOB_SCENE_NOTES_H

#include "job/observer.h"
#include "job/resolve.h"
#include "job/scene_loading.h"

namespace quintet::job {

// Reports which environment was chosen, what was repaired or ignored in the scene and its environment, whether the scene has
// surfaces, and whether its animations are used.
void noteScene(const LoadedScene& loaded, const ResolvedJob& job, Observer& observer);

}  // namespace quintet::job
#endif
