// The exception types of the public API, used by every layer.
#ifndef QUINTET_BASE_ERROR_H
#define QUINTET_BASE_ERROR_H

#include <quintet/error.h>

#endif
