// SPDX-License-Identifier: Apache-2.0
// The exception types of the public API. Every layer throws them.
#ifndef QUINTET_BASE_ERROR_H
#define QUINTET_BASE_ERROR_H

#include <quintet/error.h>

#endif
