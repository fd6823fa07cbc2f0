struct Path {
  vec3 origin;
  vec3 direction;
  vec3 throughput;
  vec3 radiance;
  uint seed;
  bool ended;
};
float random(inout uint s) {
  s = s * 1664525u + 1013904223u;
  return float(s >> 8) / 16777216.0;
}
