// A linked shader program and its uniforms by name.
#pragma once

#include <Eigen/Core>
#include <string>

#include "engine/base/result.h"
#include "render/gl/functions.h"
#include "render/gl/handle.h"

namespace spoonbill {

class Program {
 public:
  // Compiles and links GLSL sources; the version line is put in front of them. The error holds `name`, the
  // stage and the compiler's own words.
  static Result<Program> make(const GlFunctions& gl, const char* name, const std::string& vertex_source,
                              const std::string& fragment_source);

  void use() const { gl_->UseProgram(handle_.id()); }

  // The program must be in use. A name that the compiler dropped is ignored.
  void set(const char* name, int value) const;
  void set(const char* name, float value) const;
  void set(const char* name, const Eigen::Vector2f& value) const;
  void set(const char* name, const Eigen::Vector3f& value) const;
  void set(const char* name, const Eigen::Vector4f& value) const;
  void set(const char* name, const Eigen::Matrix4f& value) const;

 private:
  Program(const GlFunctions& gl, GlHandle handle) : gl_(&gl), handle_(std::move(handle)) {}

  const GlFunctions* gl_;
  GlHandle handle_;
};

}  // namespace spoonbill
