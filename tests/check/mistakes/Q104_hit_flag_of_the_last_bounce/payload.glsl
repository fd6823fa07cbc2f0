struct Payload {
  vec3 color;
  vec3 origin;
  bool hit;
};
