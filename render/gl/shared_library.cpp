#include "render/gl/shared_library.h"

#include <dlfcn.h>

namespace spoonbill {

Result<SharedLibrary> SharedLibrary::open(const char* file, const char* package) {
  void* handle = dlopen(file, RTLD_NOW | RTLD_LOCAL);
  if (handle != nullptr) return SharedLibrary(handle);
  const char* reason = dlerror();
  return Error{std::string(file) + " cannot be opened (" + (reason != nullptr ? reason : "no reason given") +
               "): install the package " + package};
}

void* SharedLibrary::symbol(const char* name) const {
  return dlsym(handle_, name);
}

}  // namespace spoonbill
