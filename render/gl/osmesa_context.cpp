#include "render/gl/osmesa_context.h"

#include <GL/osmesa.h>

#include <string>
#include <utility>

#include "render/gl/shared_library.h"

namespace spoonbill {
namespace {

// The renderer draws into framebuffers of its own, so OSMesa's is kept as small as it may be.
constexpr int own_framebuffer_side_px = 16;
constexpr int largest_side_px = 16384;

OSMesaContext context_of(void* handle) {
  return static_cast<OSMesaContext>(handle);
}

template <class Function>
bool load(const SharedLibrary& library, const char* name, Function& function) {
  function = reinterpret_cast<Function>(library.symbol(name));
  return function != nullptr;
}

}  // namespace

struct OsmesaContext::Functions {
  decltype(&OSMesaCreateContextAttribs) create = nullptr;
  decltype(&OSMesaDestroyContext) destroy = nullptr;
  decltype(&OSMesaMakeCurrent) make_current = nullptr;
  decltype(&OSMesaGetProcAddress) procedure = nullptr;
};

Result<std::unique_ptr<OsmesaContext>> OsmesaContext::make(int width_px, int height_px) {
  if (width_px < 1 || height_px < 1 || width_px > largest_side_px || height_px > largest_side_px) {
    return Error{"picture size " + std::to_string(width_px) + "x" + std::to_string(height_px) +
                 ": each side must lie between 1 and " + std::to_string(largest_side_px) + " pixels"};
  }
  const auto library = SharedLibrary::open("libOSMesa.so.8", "libosmesa6");
  if (!library) return library.error();
  auto functions = std::make_unique<Functions>();
  if (!load(library.value(), "OSMesaCreateContextAttribs", functions->create) ||
      !load(library.value(), "OSMesaDestroyContext", functions->destroy) ||
      !load(library.value(), "OSMesaMakeCurrent", functions->make_current) ||
      !load(library.value(), "OSMesaGetProcAddress", functions->procedure)) {
    return Error{
        "libOSMesa.so.8 lacks functions of OSMesa: install libosmesa6 of Debian 12 (Mesa 22 or later)"};
  }
  const int attributes[] = {OSMESA_FORMAT,
                            OSMESA_RGBA,
                            OSMESA_PROFILE,
                            OSMESA_CORE_PROFILE,
                            OSMESA_CONTEXT_MAJOR_VERSION,
                            3,
                            OSMESA_CONTEXT_MINOR_VERSION,
                            3,
                            0};
  const OSMesaContext context = functions->create(attributes, nullptr);
  if (context == nullptr) {
    return Error{
        "no OpenGL 3.3 core profile from OSMesa: install libosmesa6 of Debian 12 (Mesa 22 or later), and "
        "unset "
        "GALLIUM_DRIVER and MESA_GL_VERSION_OVERRIDE"};
  }
  return std::unique_ptr<OsmesaContext>(
      new OsmesaContext(std::move(functions), context, width_px, height_px));
}

OsmesaContext::OsmesaContext(std::unique_ptr<const Functions> functions, void* handle, int width_px,
                             int height_px)
    : functions_(std::move(functions)),
      handle_(handle),
      width_px_(width_px),
      height_px_(height_px),
      own_framebuffer_(4u * own_framebuffer_side_px * own_framebuffer_side_px) {}

OsmesaContext::~OsmesaContext() {
  functions_->destroy(context_of(handle_));
}

Status OsmesaContext::make_current() {
  if (functions_->make_current(context_of(handle_), own_framebuffer_.data(), GL_UNSIGNED_BYTE,
                               own_framebuffer_side_px, own_framebuffer_side_px) != GL_TRUE) {
    return Error{"OSMesa would not make its context current: it must not be current on another thread"};
  }
  return {};
}

GlProcedure OsmesaContext::procedure(const char* name) const {
  return functions_->procedure(name);
}

}  // namespace spoonbill
