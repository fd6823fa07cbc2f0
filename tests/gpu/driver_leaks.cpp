// With AddressSanitizer: drivers and layers keep memory until the process ends, which is no leak of ours.
// They are recognised by their file, so they must stay loaded until the leak check at the end.
#include "driver_leaks.h"

#if defined(__SANITIZE_ADDRESS__)

#include <dlfcn.h>
#include <link.h>

#include <string>
#include <vector>

extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libvulkan\nleak:libVkLayer\nleak:libLLVM\nleak:libgallium\nleak:libnvidia\nleak:libGLX_nvidia\n";
}

void quintet::test::keepDriversLoaded() {
  std::vector<std::string> files;
  ::dl_iterate_phdr(
      [](dl_phdr_info* info, std::size_t, void* data) {
        if (info->dlpi_name && *info->dlpi_name)
          static_cast<std::vector<std::string>*>(data)->push_back(info->dlpi_name);
        return 0;
      },
      &files);
  for (const std::string& file : files) ::dlopen(file.c_str(), RTLD_NOW | RTLD_NOLOAD | RTLD_NODELETE);
}

#else

void quintet::test::keepDriversLoaded() {}

#endif
