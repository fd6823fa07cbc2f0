// The one function of driver_leaks.cpp.
#ifndef QUINTET_TESTS_GPU_DRIVER_LEAKS_H
#define QUINTET_TESTS_GPU_DRIVER_LEAKS_H

namespace quintet::test {

// Call it while a device exists. Nothing without AddressSanitizer.
void keepDriversLoaded();

}  // namespace quintet::test
#endif
