struct Probe {
  float dist;
  bool occluded;
};
