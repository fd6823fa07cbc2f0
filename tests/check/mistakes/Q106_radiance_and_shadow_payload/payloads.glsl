struct Radiance {
  vec3 color;
  uint seed;
};
struct Shadow {
  float visibility;
  uint seed;
};
