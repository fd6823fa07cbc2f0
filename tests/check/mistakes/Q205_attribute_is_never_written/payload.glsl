struct Payload {
  vec3 color;
};
struct Ball {
  vec3 normal;
  float height;
};
