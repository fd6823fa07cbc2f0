struct Payload {
  vec3 radiance;
  float t;
  bool visible;
};
