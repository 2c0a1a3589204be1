#pragma once

#include <memory>
#include <string>

#include "manipulators/render/scene.h"
#include "manipulators/render/skins.h"
#include "objdb/database.h"

namespace render {

/// A world on its way into a binary glTF 2.0 file: every drawable as a node with a mesh, cameras, and, when more than
/// one moment is given, their movement as an animation. glTF's frame is ours: right-handed, metres, Y up.
///
/// Skins become glTF skins on bones with the four strongest weights of each vertex; readers blend them linearly, while
/// our own pictures use dual quaternions. Surfaces that deform in other ways keep the shape of the first moment.
class Gltf {
 public:
  Gltf();
  ~Gltf();
  Gltf(const Gltf&) = delete;
  Gltf& operator=(const Gltf&) = delete;

  /// The scene at `time` [s]. Things that come later than the first moment are left out; things that go keep still.
  void moment(const objdb::Database& world, const Scene& scene, const Skins& skins, double time);
  int moments() const;
  /// Writes FILE.glb. Returns an empty string, or what went wrong.
  std::string write(const std::string& path) const;

 private:
  class Builder;
  std::unique_ptr<Builder> builder_;
};

}  // namespace render
