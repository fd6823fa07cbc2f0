// SPDX-License-Identifier: Apache-2.0
// Workgroups of compute passes with one invocation per element (see src/render/compute_pass.h).
#ifndef QUINTET_SHARED_PASS_H
#define QUINTET_SHARED_PASS_H

#include "types.h"

QT_SHARED_BEGIN

// Workgroups form rows of kPassColumns, because a single dimension would exceed the device limit for large arrays.
QT_CONSTANT kPassGroupSize = 64;
QT_CONSTANT kPassColumns = 32768;
// Size of the push constants of a scene's pipelines, which share one layout: ray tracing programs (shared::Launch) and passes.
QT_CONSTANT kPushConstantBytes = 48;

QT_SHARED_END

#endif
