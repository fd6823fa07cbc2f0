#version 460
#extension GL_EXT_ray_tracing : require
layout(location = 0) rayPayloadInEXT vec3 c;
void main() {
  const float cosine = max(dot(normalize(vec3(1, 2, 3)), -gl_WorldRayDirectionEXT), 0.0);
  c = vec3(0.1) + pow(cosine, 40.0) * pow(vec3(0.9, 0.8, 0.7), vec3(2.2)) + 0.1 * sqrt(cosine);
}
