struct Sight {
  vec3 point;
  bool blocked;
};
