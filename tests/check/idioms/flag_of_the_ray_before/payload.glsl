struct Payload {
  vec3 color;
  vec3 position;
  bool hit;
};
