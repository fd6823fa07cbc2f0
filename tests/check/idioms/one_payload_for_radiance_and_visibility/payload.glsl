struct Payload {
  vec3 color;
  float visibility;
};
