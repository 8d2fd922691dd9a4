// A GL context: what the renderer needs of OSMesa and of a window alike. A context belongs to the thread that
// made it current; the renderer draws on that thread alone.
#pragma once

#include "engine/base/result.h"

namespace spoonbill {

using GlProcedure = void (*)();

class GlContext {
 public:
  virtual ~GlContext() = default;

  // Makes the context current on the calling thread. The error names the remedy.
  virtual Status make_current() = 0;

  // The address of a GL function, null where the context lacks it. GL must be called through this alone: the
  // usual loaders look into libGL, which knows nothing of an OSMesa context. The context must be current.
  virtual GlProcedure procedure(const char* name) const = 0;

  // The size of a frame in pixels. A window's may change between frames.
  virtual int width_px() const = 0;
  virtual int height_px() const = 0;

  // Whether framebuffer 0 is shown to somebody. Without a window the renderer never draws into it.
  virtual bool has_window() const = 0;

  // Shows what was drawn into framebuffer 0; does nothing without a window.
  virtual void swap() = 0;
};

}  // namespace spoonbill
