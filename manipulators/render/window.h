#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "manipulators/render/bindings.h"
#include "manipulators/render/canvas.h"
#include "manipulators/render/scene.h"

namespace render {

/// An object that may be dragged: its own place is a point in its parent's frame.
struct Handle {
  std::string path;
  Eigen::Isometry3d X_WP = Eigen::Isometry3d::Identity();  ///< the parent's frame in the world
};

/// What a window shows. Nothing in it changes once it is shown.
struct Shown {
  Scene scene;
  Camera camera;
  Quality quality = Quality::good;
  std::vector<Handle> handles;
};

/// A window on an X display, served by a thread of its own with a canvas of its own, so that it answers while the
/// world stands still or computes. Lines that gestures say are handed to `say` from that thread.
///
/// Left button: drag an object in the plane of the picture, or turn the camera; click to see an object's path.
/// Middle button or Shift: shift. Right button or wheel: nearer and farther. Home: the world's own camera again.
/// A binding replaces what the event does by itself.
class Window {
 public:
  enum class State {
    open,
    closed,  ///< by the person at it
    lost,    ///< its X server is gone
  };

  /// Opens a window on the display named by DISPLAY. Null with `problem` when there is none or it cannot draw.
  static std::unique_ptr<Window> open(Size size, std::function<void(const std::string&)> say, std::string& problem);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// What to show from now on. Only the latest counts.
  void show(Shown shown);
  void bind(const std::string& event, const std::string& command);
  bool unbind(const std::string& event);
  State state() const;
  /// How many pictures have been put on the screen.
  long long pictures() const;

 private:
  class Server;
  explicit Window(std::unique_ptr<Server> server);
  std::unique_ptr<Server> server_;
};

}  // namespace render
