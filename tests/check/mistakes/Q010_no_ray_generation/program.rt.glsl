/**** COMMON START ****/  // EXPECT Q010
struct RayPayloadType {
  vec3 color;
  float t;  // negative if the ray hit nothing
};
/**** COMMON END ****/

void main() { /**** CALLABLE SHADER ****/
  vec2 point = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  vec3 direction = normalize(vec3(point, -2.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  payload.color = vec3(baryCoord, 1.0);
  payload.t = gl_HitTEXT;
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.0);
  payload.t = -1.0;
}
