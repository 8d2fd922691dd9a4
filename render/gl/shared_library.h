// A shared library that is opened by name when something needs it, instead of with the program: OSMesa brings
// LLVM along, whose relocations alone take longer than most commands.
#pragma once

#include <string>

#include "engine/base/result.h"

namespace spoonbill {

// Stays open until the process ends: drivers do not bear being unloaded, and opening it again costs nothing.
// From any thread.
class SharedLibrary {
 public:
  // `file` is what the dynamic linker looks for ("libOSMesa.so.8"), `package` the Debian package that has it.
  // Refused, naming both, where the library is missing or does not load.
  static Result<SharedLibrary> open(const char* file, const char* package);

  // The address of a function or variable; null where the library has none of this name.
  void* symbol(const char* name) const;

 private:
  explicit SharedLibrary(void* handle) : handle_(handle) {}

  void* handle_;
};

}  // namespace spoonbill
