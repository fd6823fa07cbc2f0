struct Hit {
  bool found;
  vec3 position, normal;
};
