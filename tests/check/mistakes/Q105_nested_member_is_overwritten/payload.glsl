struct Path {
  float weight;
  int depth;
};
struct Payload {
  vec3 color;
  Path path;
};
