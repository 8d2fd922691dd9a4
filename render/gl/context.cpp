#include "render/gl/context.h"

#if defined(__GLIBC__) || __has_include(<malloc.h>)
#include <malloc.h>
#endif

#include <GL/osmesa.h>
#include <dlfcn.h>

#include <string>
#include <utility>

namespace spoonbill {

namespace {

// Side of OSMesa's own framebuffer. It is small, because the renderer draws into framebuffers of its own.
constexpr int own_framebuffer_side_px = 16;
constexpr int maximum_side_px = 16384;

OSMesaContext as_context(void* handle) {
  return static_cast<OSMesaContext>(handle);
}

template <class Function>
bool load_symbol(const SharedLibrary& library, const char* name, Function& function) {
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
  if (width_px < 1 || height_px < 1 || width_px > maximum_side_px || height_px > maximum_side_px) {
    return Error{ErrorCode::out_of_range, "picture size " + std::to_string(width_px) + "x" +
                                              std::to_string(height_px) + ": each side must be from 1 to " +
                                              std::to_string(maximum_side_px) + " pixels"};
  }
  const auto library = SharedLibrary::open("libOSMesa.so.8", "libosmesa6");
  if (!library) return library.error();
  auto functions = std::make_unique<Functions>();
  if (!load_symbol(library.value(), "OSMesaCreateContextAttribs", functions->create) ||
      !load_symbol(library.value(), "OSMesaDestroyContext", functions->destroy) ||
      !load_symbol(library.value(), "OSMesaMakeCurrent", functions->make_current) ||
      !load_symbol(library.value(), "OSMesaGetProcAddress", functions->procedure)) {
    return Error{
        ErrorCode::unavailable,
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
        ErrorCode::unavailable,
        "OSMesa has no OpenGL 3.3 core profile: install libosmesa6 of Debian 12 (Mesa 22 or later), and "
        "unset GALLIUM_DRIVER and MESA_GL_VERSION_OVERRIDE"};
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
  functions_->destroy(as_context(handle_));
}

Status OsmesaContext::make_current() {
  if (functions_->make_current(as_context(handle_), own_framebuffer_.data(), GL_UNSIGNED_BYTE,
                               own_framebuffer_side_px, own_framebuffer_side_px) != GL_TRUE) {
    return Error{ErrorCode::in_use,
                 "the OSMesa context cannot be made current: it must not be current on another thread"};
  }
  return {};
}

GlProcedure OsmesaContext::procedure(const char* name) const {
  return functions_->procedure(name);
}

Result<SharedLibrary> SharedLibrary::open(const char* file, const char* package) {
  void* handle = dlopen(file, RTLD_NOW | RTLD_LOCAL);
  if (handle != nullptr) return SharedLibrary(handle);
  const char* reason = dlerror();
  return Error{ErrorCode::unavailable, std::string(file) + " cannot be opened (" +
                                           (reason != nullptr ? reason : "no reason given") +
                                           "): install the package " + package};
}

void* SharedLibrary::symbol(const char* name) const {
  return dlsym(handle_, name);
}

void retain_freed_memory() {
#ifdef M_MMAP_THRESHOLD
  constexpr int one_gibibyte = 1 << 30;
  mallopt(M_MMAP_THRESHOLD, one_gibibyte);
  mallopt(M_TRIM_THRESHOLD, one_gibibyte);
  constexpr int grow_step = 64 << 20;
  mallopt(M_TOP_PAD, grow_step);
#endif
}

}  // namespace spoonbill
