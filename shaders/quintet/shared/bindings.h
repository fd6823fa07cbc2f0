// SPDX-License-Identifier: Apache-2.0
// Bindings of the only descriptor set. All other data is passed by buffer address (shared/frame.h).
#ifndef QUINTET_SHARED_BINDINGS_H
#define QUINTET_SHARED_BINDINGS_H

#include "types.h"

QT_SHARED_BEGIN
QT_CONSTANT kBindingTlas = 0;
QT_CONSTANT kBindingTextures = 1;
QT_SHARED_END

#endif
