// The one translation unit that holds volk's functions and its instance-level function pointers.
#define VOLK_IMPLEMENTATION
#include <volk.h>
