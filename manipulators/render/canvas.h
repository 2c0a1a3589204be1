#pragma once

#include <memory>
#include <string>

#include "manipulators/render/picture.h"
#include "manipulators/render/scene.h"

namespace render {

/// How much work a picture is worth.
enum class Quality {
  draft,  ///< no antialiasing, hard-edged shadow
  good,   ///< four samples a pixel, soft shadow, contact shadows from depth: the everyday setting
  best,   ///< the same at twice the size, averaged: for stills
};

/// What a picture took.
struct Cost {
  int drawn = 0;            ///< drawables drawn
  int culled = 0;           ///< drawables left out: outside the view or too small
  long long triangles = 0;  ///< triangles sent in the colour pass
  int calls = 0;            ///< draw calls in all passes
  double cpu_seconds = 0;   ///< processor time of this process, all threads [s]: differs from run to run
};

/// Draws scenes into pictures. Owns the graphics context and what has been uploaded to it; one thread only.
class Canvas {
 public:
  /// Null if there is no usable graphics context; `problem` then says why.
  static std::unique_ptr<Canvas> make(std::string& problem);
  ~Canvas();
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;

  /// Draws `scene` as `camera` sees it; `picture` gets `size`, which must be acceptable to `size_problem`.
  /// Labels are written on top. Returns an empty string, or what went wrong (out of memory in the rasterizer).
  std::string draw(const Scene& scene, const Camera& camera, Size size, Quality quality, Picture& picture);

  const Cost& cost() const;
  /// Version and rasterizer in words.
  std::string description() const;

 private:
  class State;
  explicit Canvas(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace render
