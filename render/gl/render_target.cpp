#include "render/gl/render_target.h"

#include <algorithm>
#include <string>

namespace spoonbill {
namespace {

// GL_PACK_INVERT_MESA of GL_MESA_pack_invert, an extension of Mesa that flips rows while reading.
constexpr GLenum pack_top_row_first = 0x8758;

}  // namespace

RenderTarget::RenderTarget(const GlFunctions& gl, PixelSize frame, PixelSize scene, int samples,
                           GLenum channels)
    : gl_(&gl),
      frame_size_(frame),
      scene_size_(scene),
      samples_(samples),
      channels_(channels),
      scene_colour_(make_texture(gl)),
      scene_depth_(make_renderbuffer(gl)),
      scene_(make_framebuffer(gl)),
      frame_colour_(make_texture(gl)),
      frame_(make_framebuffer(gl)) {
  const GLenum kind = scene_texture_kind();
  gl.BindTexture(kind, scene_colour_.id());
  if (samples > 0) {
    gl.TexImage2DMultisample(kind, samples, GL_RGBA8, scene.width_px, scene.height_px, GL_TRUE);
  } else {
    gl.TexImage2D(kind, 0, GL_RGBA8, scene.width_px, scene.height_px, 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
    gl.TexParameteri(kind, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    gl.TexParameteri(kind, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    gl.TexParameteri(kind, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    gl.TexParameteri(kind, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  }
  gl.BindRenderbuffer(GL_RENDERBUFFER, scene_depth_.id());
  gl.RenderbufferStorageMultisample(GL_RENDERBUFFER, samples, GL_DEPTH_COMPONENT24, scene.width_px,
                                    scene.height_px);
  gl.BindFramebuffer(GL_FRAMEBUFFER, scene_.id());
  gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, kind, scene_colour_.id(), 0);
  gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, scene_depth_.id());

  gl.BindTexture(GL_TEXTURE_2D, frame_colour_.id());
  gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, frame.width_px, frame.height_px, 0, channels, GL_UNSIGNED_BYTE,
                nullptr);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  gl.BindFramebuffer(GL_FRAMEBUFFER, frame_.id());
  gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, frame_colour_.id(), 0);

  while (gl.GetError() != GL_NO_ERROR) {
  }
  gl.PixelStorei(pack_top_row_first, GL_FALSE);
  packs_top_row_first_ = gl.GetError() == GL_NO_ERROR;
}

Result<RenderTarget> RenderTarget::make(const GlFunctions& gl, PixelSize frame, PixelSize scene, int samples,
                                        GLenum channels) {
  if (samples != 0 && samples != 4) {
    return Error{ErrorCode::out_of_range, "samples is " + std::to_string(samples) + ", must be 0 or 4",
                 "samples"};
  }
  RenderTarget target(gl, frame, scene, samples, channels);
  for (const GlHandle* framebuffer : {&target.scene_, &target.frame_}) {
    if (Status status = target.check(framebuffer->id()); !status) return status.error();
  }
  return target;
}

Status RenderTarget::check(GLuint framebuffer) const {
  gl_->BindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  if (gl_->CheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE) return {};
  return Error{ErrorCode::unsupported, "no framebuffer of " + std::to_string(width_px()) + "x" +
                                           std::to_string(height_px()) + " pixels with " +
                                           std::to_string(samples_) +
                                           " samples: choose a smaller size or samples = 0"};
}

void RenderTarget::begin_scene(std::span<const PixelArea> areas) const {
  gl_->BindFramebuffer(GL_FRAMEBUFFER, scene_.id());
  gl_->Viewport(0, 0, scene_size_.width_px, scene_size_.height_px);
  gl_->DepthMask(GL_TRUE);
  gl_->ClearColor(0.0f, 0.0f, 0.0f, 0.0f);
  gl_->Enable(GL_SCISSOR_TEST);
  // A stretched scene is filtered, so that the pixels around an area show too.
  const int margin = scene_size_ == frame_size_ ? 0 : 1;
  for (const PixelArea& area : areas) {
    const int left = std::max(area.x - margin, 0), bottom = std::max(area.y - margin, 0);
    gl_->Scissor(left, bottom, area.x + area.width + margin - left, area.y + area.height + margin - bottom);
    gl_->Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  }
  gl_->Disable(GL_SCISSOR_TEST);
}

void RenderTarget::begin_frame() const {
  gl_->BindFramebuffer(GL_FRAMEBUFFER, frame_.id());
  gl_->Disable(GL_SCISSOR_TEST);
  gl_->Viewport(0, 0, width_px(), height_px());
}

void RenderTarget::clear_frame() const {
  begin_frame();
  gl_->ClearColor(0.0f, 0.0f, 0.0f, 0.0f);
  gl_->Clear(GL_COLOR_BUFFER_BIT);
}

void RenderTarget::read(Image& image) const {
  image.resize(width_px(), height_px());
  gl_->BindFramebuffer(GL_READ_FRAMEBUFFER, frame_.id());
  gl_->PixelStorei(GL_PACK_ALIGNMENT, 1);
  if (packs_top_row_first_) gl_->PixelStorei(pack_top_row_first, GL_TRUE);
  gl_->ReadPixels(0, 0, width_px(), height_px(), GL_RGBA, GL_UNSIGNED_BYTE, image.rgba.data());
  if (packs_top_row_first_) {
    gl_->PixelStorei(pack_top_row_first, GL_FALSE);
  } else {
    flip_rows(image);
  }
}

void RenderTarget::copy_to_window() const {
  gl_->BindFramebuffer(GL_READ_FRAMEBUFFER, frame_.id());
  gl_->BindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
  gl_->BlitFramebuffer(0, 0, width_px(), height_px(), 0, 0, width_px(), height_px(), GL_COLOR_BUFFER_BIT,
                       GL_NEAREST);
}

}  // namespace spoonbill
