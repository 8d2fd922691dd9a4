// A GL context without window or display: Mesa's software renderer drawing into memory.
#pragma once

#include <memory>
#include <vector>

#include "render/gl/context.h"

namespace spoonbill {

class OsmesaContext final : public GlContext {
 public:
  // A core profile of 3.3 or later. The context is not current yet. Refused, with the remedy: sizes outside
  // 1..16384, no libOSMesa, a Mesa without a core profile.
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

}  // namespace spoonbill
