struct Payload {
  int layers;
};
