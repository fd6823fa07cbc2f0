// SPDX-License-Identifier: Apache-2.0
// Lesson 14: constructive solid geometry. One intersection shader computes union, intersection and difference of a
// sphere and a box. Each solid has an interval of t in which the ray is inside; the operation combines the intervals.
// scene: csg.scene.toml
/**** COMMON START ****/
struct RayPayloadType {
  vec3 color;
};
struct HitAttributeType {
  vec3 normal;  // pointing out of the combined solid, object space
  float solid;  // whose surface is hit: 0 the box, 1 the sphere
};

uniform vec3 eye;         // defaultval="0, 2.5, 7" unit="m" help="Position of the camera"
uniform float sphereSize; // defaultval="1.25" min="0.5" max="1.7" help="Radius of the spheres divided by half the side of the boxes"

const int opUnion = 0;
const int opIntersection = 1;
const int opDifference = 2;
const float never = 1e30;
/**** COMMON END ****/

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  float aspect = float(gl_LaunchSizeEXT.x) / float(gl_LaunchSizeEXT.y);
  vec3 back = normalize(eye);
  vec3 right = normalize(cross(vec3(0.0, 1.0, 0.0), back));
  vec2 plane = ndc * vec2(aspect, 1.0) * tan(0.5 * radians(40.0));
  vec3 direction = normalize(plane.x * right + plane.y * cross(back, right) - back);
  traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, 0u, 0u, 0u, eye, 0.001, direction, 1000.0, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

// Returns the interval of a sphere centered at the origin; x > y if the ray misses.
vec2 sphereInterval(vec3 o, vec3 d, float radius) {
  float a = dot(d, d);
  float b = dot(o, d);
  vec3 nearest = o - (b / a) * d;
  float discriminant = a * (radius * radius - dot(nearest, nearest));
  if (discriminant < 0.0) return vec2(never, -never);
  float q = sqrt(discriminant);
  return vec2(-b - q, -b + q) / a;
}

// Returns the interval of the cube [-h, h]³; x > y if the ray misses.
vec2 cubeInterval(vec3 o, vec3 d, float h) {
  vec3 ta = (vec3(-h) - o) / d;
  vec3 tb = (vec3(h) - o) / d;
  vec3 first = min(ta, tb);
  vec3 last = max(ta, tb);
  return vec2(max(first.x, max(first.y, first.z)), min(last.x, min(last.y, last.z)));
}

bool contains(vec2 interval, float t) { return interval.x <= t && t < interval.y; }

// Returns whether the point just after t is inside the combined solid.
bool insideAfter(int op, vec2 box, vec2 ball, float t) {
  bool inBox = contains(box, t);
  bool inBall = contains(ball, t);
  return op == opUnion ? inBox || inBall : op == opIntersection ? inBox && inBall : inBox && !inBall;
}

void main() { /**** INTERSECTION SHADER ****/
  vec3 boxMin, boxMax;
  gsnGetIntersectionBox(gl_InstanceID, gl_PrimitiveID, boxMin, boxMax);
  vec3 o = gl_ObjectRayOriginEXT - 0.5 * (boxMin + boxMax);
  vec3 d = gl_ObjectRayDirectionEXT;
  // The boxes of the scene leave room for the union: the side of the cube is 0.55 of theirs.
  float halfSide = 0.55 * 0.5 * (boxMax.x - boxMin.x);
  float radius = sphereSize * halfSide;
  int op = gl_PrimitiveID % 3;

  vec2 box = cubeInterval(o, d, halfSide);
  vec2 ball = sphereInterval(o, d, radius);
  if (box.x > box.y) box = vec2(never, -never);

  // The candidates are the four ends of the intervals. The hit is the first one in [tmin, tmax] at which the ray passes
  // from inside to outside or back. This finds both pieces of a difference that consists of two.
  float t = never;
  bool ofBall = false;
  for (int i = 0; i < 4; ++i) {
    float candidate = i == 0 ? box.x : i == 1 ? box.y : i == 2 ? ball.x : ball.y;
    if (!(candidate >= gl_RayTminEXT && candidate <= gl_RayTmaxEXT && candidate < t)) continue;
    // The state just before the candidate is the state after the latest earlier end.
    float before = -never;
    if (box.x < candidate) before = max(before, box.x);
    if (box.y < candidate) before = max(before, box.y);
    if (ball.x < candidate) before = max(before, ball.x);
    if (ball.y < candidate) before = max(before, ball.y);
    if (insideAfter(op, box, ball, before) == insideAfter(op, box, ball, candidate)) continue;
    t = candidate;
    ofBall = i >= 2;
  }
  if (t >= never) return;

  vec3 normal;
  if (ofBall) {
    normal = (o + t * d) / radius;
  } else {
    // As in lesson 12: the face is the one whose plane has this t.
    vec3 ta = (vec3(-halfSide) - o) / d;
    vec3 tb = (vec3(halfSide) - o) / d;
    bool entersBox = t == box.x;
    vec3 planes = entersBox ? min(ta, tb) : max(ta, tb);
    vec3 gap = abs(planes - t);
    int axis = gap.x <= gap.y && gap.x <= gap.z ? 0 : gap.y <= gap.z ? 1 : 2;
    normal = vec3(0.0);
    normal[axis] = (d[axis] > 0.0) == entersBox ? -1.0 : 1.0;
  }
  if (op == opDifference && ofBall) normal = -normal;  // the normal of the hole points into the sphere
  hit.normal = normal;
  hit.solid = ofBall ? 1.0 : 0.0;
  reportIntersectionEXT(t, dot(normal, d) < 0.0 ? 1u : 2u);
}

void main() { /**** CLOSEST-HIT SHADER ****/
  mat3 normalMatrix;
  gsnGetNormal3x3Matrix(gl_InstanceID, normalMatrix);
  vec3 normal = normalize(normalMatrix * hit.normal);
  vec3 base = hit.solid > 0.5 ? vec3(0.2, 0.45, 0.7) : vec3(0.85, 0.6, 0.25);
  payload.color = base * (0.25 + 0.75 * max(dot(normal, normalize(vec3(0.5, 1.0, 0.8))), 0.0));
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.1, 0.12, 0.16);
}
