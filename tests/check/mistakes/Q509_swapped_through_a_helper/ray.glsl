struct Hit {
  float distance;
};
