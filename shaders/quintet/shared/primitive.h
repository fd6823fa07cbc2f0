// SPDX-License-Identifier: Apache-2.0
// Analytic solids and CSG trees (constructive solid geometry) on the device; scene/model/procedural.h documents them.
#ifndef QUINTET_SHARED_PRIMITIVE_H
#define QUINTET_SHARED_PRIMITIVE_H

#include "types.h"

QT_SHARED_BEGIN

// GeometryData::kind
QT_CONSTANT kGeometryTriangles = 0u;
QT_CONSTANT kGeometrySolids = 1u;
QT_CONSTANT kGeometryCsg = 2u;
QT_CONSTANT kGeometryCustom = 3u;  // boxes with a surface defined by a user's intersection shader

// PrimitiveData::type
QT_CONSTANT kPrimitiveSphere = 0u;
QT_CONSTANT kPrimitiveBox = 1u;
QT_CONSTANT kPrimitiveCylinder = 2u;
QT_CONSTANT kPrimitiveCone = 3u;
QT_CONSTANT kPrimitiveTorus = 4u;

// A canonical solid under an affine transform.
struct PrimitiveData {
  vec4 primitiveFromObject[3];  // rows
  vec4 objectFromPrimitive[3];
  uint type;
  float parameter;  // torus: minor radius, (0,1)
  uint material;
  uint padding;
};
QT_SHARED_SIZE(PrimitiveData, 112);

// CsgNodeData::operation
QT_CONSTANT kCsgLeaf = 0u;
QT_CONSTANT kCsgUnite = 1u;
QT_CONSTANT kCsgIntersect = 2u;
QT_CONSTANT kCsgSubtract = 3u;

// A node of a tree in postfix order; at most 32 operands are on the stack.
struct CsgNodeData {
  uint operation;
  uint operand;  // leaf: index in GeometryData::primitives; else the number of nodes of the second operand
};
QT_SHARED_SIZE(CsgNodeData, 8);

struct CsgTreeData {
  uint firstNode;  // in GeometryData::nodes
  uint nodeCount;
};
QT_SHARED_SIZE(CsgTreeData, 8);

struct BoxData {
  vec3 min;  // object space
  vec3 max;
};
QT_SHARED_SIZE(BoxData, 24);

QT_SHARED_END

#endif
