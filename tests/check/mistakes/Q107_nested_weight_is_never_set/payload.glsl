struct Path {
  vec3 weight;
  uint seed;
};
struct Payload {
  vec3 color;
  Path path;
};
