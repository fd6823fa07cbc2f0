// Acceleration structures of both levels.
#ifndef QUINTET_RT_ACCELERATION_STRUCTURE_H
#define QUINTET_RT_ACCELERATION_STRUCTURE_H

#include "rt/blas.h"
#include "rt/tlas.h"

#endif
