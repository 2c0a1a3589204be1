#pragma once

#include <initializer_list>
#include <string>
#include <unordered_map>
#include <vector>

#include "manipulators/render/picture.h"
#include "manipulators/render/scene.h"

/// Thin owners of graphics objects. All need a current context.
namespace render::gl {

/// The graphics library's name of an object; its own header is too heavy for headers.
using Name = unsigned int;

/// A linked pair of shaders with its uniform locations.
class Program {
 public:
  /// Compiles and links; on failure `problem` gets the compiler's words. The samplers are bound to texture units
  /// 0 shadow_map, 1 occlusion_map, 2 color_map, 3 geometry_map and the block `Frame` to binding 0.
  Program(const std::string& vertex, const std::string& fragment, std::string& problem);
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  void use() const;
  void set(const char* name, const Eigen::Matrix4f& value);
  void set(const char* name, const Eigen::Matrix3f& value);
  void set(const char* name, const Eigen::Vector4f& value);

 private:
  int location(const char* name);
  Name id_ = 0;
  std::unordered_map<std::string, int> locations_;
};

/// A texture that can be drawn into.
class Image {
 public:
  enum class Kind {
    color,   ///< RGBA8, read with interpolation
    floats,  ///< four 32-bit floats
    depth,   ///< 24 bits
    shadow,  ///< the same, read by interpolated comparison
    single,  ///< one channel of 8 bits, read with interpolation
  };
  Image(Kind kind, Size size);
  ~Image();
  Image(const Image&) = delete;
  Image& operator=(const Image&) = delete;

  Name id() const { return id_; }
  Kind kind() const { return kind_; }
  Size size() const { return size_; }
  /// Makes it what the samplers bound to that unit read.
  void bind(int unit) const;

 private:
  Kind kind_;
  Size size_;
  Name id_ = 0;
};

/// A set of images of one size that are drawn into together.
class Target {
 public:
  explicit Target(std::initializer_list<const Image*> images);
  ~Target();
  Target(const Target&) = delete;
  Target& operator=(const Target&) = delete;

  /// Draws go here from now on.
  void use() const;
  bool complete() const { return complete_; }

 private:
  Size size_;
  Name frame_ = 0;
  bool complete_ = false;
};

/// Geometries kept in the graphics library, by their id.
class Store {
 public:
  ~Store();
  /// Sends what has changed and binds it for drawing.
  void bind(const Geometry& geometry);
  /// Draws `span` of `level` of the geometry bound last.
  void draw(const Geometry& geometry, std::size_t level, const Span& span) const;
  /// Draws the whole level.
  void draw(const Geometry& geometry, std::size_t level) const;
  /// Forgets what has not been bound during the last `frames` calls of this function.
  void age(int frames);

 private:
  struct Entry {
    Name array = 0;
    Name vertices = 0;
    Name indices = 0;
    std::uint64_t generation = 0;
    std::uint64_t topology = 0;
    std::vector<std::size_t> level_starts;
    int last_use = 0;
  };
  std::unordered_map<std::uint64_t, Entry> entries_;
  const Entry* bound_ = nullptr;
  int now_ = 0;
};

}  // namespace render::gl
