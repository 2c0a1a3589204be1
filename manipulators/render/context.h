#pragma once

#include <memory>
#include <string>

namespace render {

/// A graphics context to draw in without a screen. One implementation today, Mesa's off-screen rasterizer (OSMesa);
/// another back end (EGL without a surface) is one more class behind this interface.
/// Only one thread may use a context.
class Context {
 public:
  virtual ~Context() = default;
  /// Makes the graphics calls of this thread go to this context. Returns an empty string, or what went wrong.
  virtual std::string use() = 0;
  /// Version and rasterizer in words.
  virtual std::string description() const = 0;
};

/// An OpenGL 3.3 core context on OSMesa. On failure the pointer is null and `problem` says why.
std::unique_ptr<Context> make_osmesa_context(std::string& problem);

}  // namespace render
