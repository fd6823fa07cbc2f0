// SPDX-License-Identifier: Apache-2.0
// Lesson 09: smooth edges, frame by frame. Each frame takes one sample in the pixel at a point of the Halton sequence
// in bases 2 and 3. The image is the average of all frames so far.
// scene: progressive.scene.toml
/**** COMMON START ****/
struct RayPayloadType {
  vec3 color;
};

uniform bool jitter;  // defaultval="true" help="Sample the area of the pixel instead of only its center"
uniform int points;   // defaultval="0" min="0" max="2" help="Points: 0 Halton, 1 Halton with a shift per pixel, 2 random"
/**** COMMON END ****/

// Returns the radical inverse: the digits of `index` in this base, mirrored at the radix point (Halton 1960).
float halton(int index, int base) {
  float value = 0.0;
  float digit = 1.0;
  for (int i = index; i > 0; i /= base) {
    digit /= float(base);
    value += digit * float(i % base);
  }
  return value;
}

uint hash(uint x) {
  x = x * 747796405u + 2891336453u;
  x = ((x >> ((x >> 28u) + 4u)) ^ x) * 277803737u;
  return (x >> 22u) ^ x;
}
float uniformFrom(uint seed) { return float(hash(seed) >> 8u) / 16777216.0; }

// Returns the point of this frame in the pixel, in [0, 1]².
vec2 pointInPixel(uint pixel) {
  if (points == 2) {
    uint seed = hash(pixel ^ hash(uint(frameID)));
    return vec2(uniformFrom(seed), uniformFrom(seed + 1u));
  }
  // Starts at index 1, because index 0 is the corner of the pixel.
  vec2 point = vec2(halton(frameID + 1, 2), halton(frameID + 1, 3));
  if (points == 0) return point;
  // Cranley and Patterson (1976): a random shift per pixel, modulo 1.
  return fract(point + vec2(uniformFrom(2u * pixel), uniformFrom(2u * pixel + 1u)));
}

void main() { /**** RAY GENERATION SHADER ****/
  uint pixel = gl_LaunchIDEXT.y * gl_LaunchSizeEXT.x + gl_LaunchIDEXT.x;
  vec2 offset = jitter ? pointInPixel(pixel) : vec2(0.5);
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + offset) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  float aspect = float(gl_LaunchSizeEXT.x) / float(gl_LaunchSizeEXT.y);
  vec3 direction = normalize(vec3(ndc * vec2(aspect, 1.0) * tan(0.5 * radians(30.0)), -1.0));
  traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, 0u, 0u, 0u, vec3(0.0, 1.0, 6.0), 0.001, direction, 1000.0, 0);

  // The mean of n + 1 frames from the mean of n.
  vec3 mean = gsnGetPreviousPixel().rgb;
  mean += (payload.color - mean) / float(frameID + 1);
  gsnSetPixel(vec4(mean, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  vec3 p0, p1, p2;
  gsnGetPositions(gl_InstanceID, gl_PrimitiveID, p0, p1, p2);
  mat3 normalMatrix;
  gsnGetNormal3x3Matrix(gl_InstanceID, normalMatrix);
  vec3 normal = normalize(normalMatrix * cross(p1 - p0, p2 - p0));
  payload.color = vec3(0.9, 0.6, 0.3) * (0.3 + 0.7 * abs(dot(normal, normalize(vec3(0.4, 0.7, 1.0)))));
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.05, 0.07, 0.1);
}
