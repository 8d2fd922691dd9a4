// The fixed-function state of a draw call. Every pass states all of it, so that no pass depends on what ran
// before. Scissoring is the render target's and the interface's.
#pragma once

#include "render/gl/functions.h"

namespace spoonbill {

enum class Depth { off, test, test_and_write };
enum class Blend { off, premultiplied, maximum };  // over what is there; the greater of both, by channel
enum class Cull { off, back, front };

struct PipelineState {
  Depth depth = Depth::off;
  Blend blend = Blend::off;
  Cull cull = Cull::off;
};

void set_pipeline_state(const GlFunctions& gl, const PipelineState& state);

}  // namespace spoonbill
