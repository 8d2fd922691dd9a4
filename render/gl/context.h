// GL contexts: the interface that the renderer uses, and the offscreen context of Mesa's software renderer.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/base/result.h"

namespace spoonbill {

using GlProcedure = void (*)();

// A GL context, offscreen or with a window. It belongs to the thread that made it current, and the renderer
// draws only on that thread.
class GlContext {
 public:
  virtual ~GlContext() = default;

  // Makes the context current on the calling thread. Errors name the remedy.
  virtual Status make_current() = 0;

  // Returns the address of a GL function, or null if the context lacks it. All GL calls must use these
  // addresses: the usual loaders search libGL, which does not work with an OSMesa context. The context must
  // be current.
  virtual GlProcedure procedure(const char* name) const = 0;

  // Size of a frame in pixels. The size of a window may change between frames.
  virtual int width_px() const = 0;
  virtual int height_px() const = 0;

  // Returns whether framebuffer 0 is visible. Without a window the renderer never draws into it.
  virtual bool has_window() const = 0;

  // Shows the contents of framebuffer 0; does nothing without a window.
  virtual void swap() = 0;
};

// A GL context without window or display: Mesa's software renderer, which draws into memory.
class OsmesaContext final : public GlContext {
 public:
  // Makes a context with a core profile of OpenGL 3.3 or later. The context is not current yet. Errors, with
  // the remedy: sizes outside 1 to 16384, no libOSMesa, a Mesa without a core profile.
  static Result<std::unique_ptr<OsmesaContext>> make(int width_px, int height_px);

  ~OsmesaContext() override;
  OsmesaContext(const OsmesaContext&) = delete;
  OsmesaContext& operator=(const OsmesaContext&) = delete;

  Status make_current() override;
  GlProcedure procedure(const char* name) const override;
  int width_px() const override { return width_px_; }
  int height_px() const override { return height_px_; }
  bool has_window() const override { return false; }
  void swap() override {}

 private:
  struct Functions;

  OsmesaContext(std::unique_ptr<const Functions> functions, void* handle, int width_px, int height_px);

  std::unique_ptr<const Functions> functions_;

  void* handle_;  // OSMesaContext
  int width_px_;
  int height_px_;
  std::vector<unsigned char> own_framebuffer_;
};

// A shared library opened by name when it is needed, not at program start. OSMesa depends on LLVM, whose
// relocations alone take longer than most commands of the program.
//
// The library stays open until the process ends: drivers do not support unloading, and opening the library
// again costs nothing. May be used from any thread.
class SharedLibrary {
 public:
  // Opens a library. `file` is the name for the dynamic linker ("libOSMesa.so.8") and `package` the Debian
  // package that provides it. The error names both.
  static Result<SharedLibrary> open(const char* file, const char* package);

  // Returns the address of a function or variable, or null if the library has none with this name.
  void* symbol(const char* name) const;

 private:
  explicit SharedLibrary(void* handle) : handle_(handle) {}

  void* handle_;
};

// Makes the allocator retain freed memory, up to 1 GiB. By default glibc returns large blocks to the system
// after every frame. Clearing fresh pages then takes the software renderer a third of the frame's time.
//
// Call once at program start, before the first context and before other threads, if the program draws. Does
// nothing without glibc.
void retain_freed_memory();

}  // namespace spoonbill
