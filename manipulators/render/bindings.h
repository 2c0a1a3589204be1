#pragma once

#include <Eigen/Core>
#include <map>
#include <string>

namespace render {

/// What a person did at the window, and where.
struct Gesture {
  std::string event;  ///< e.g. Key-space, Shift-Button1, Button1-drag, Wheel-up
  std::string path;   ///< of the object under the pointer, or being dragged; empty for none
  bool has_point = false;
  Eigen::Vector3d point{0, 0, 0};  ///< on that object, or where it was dragged to [m, world]
};

/// Which event says which command.
class Bindings {
 public:
  /// Empty when `event` can happen, otherwise the sentence that says what events look like.
  static std::string event_problem(const std::string& event);
  void bind(const std::string& event, std::string command) { commands_[event] = std::move(command); }
  /// False when it was not bound.
  bool unbind(const std::string& event) { return commands_.erase(event) > 0; }
  bool bound(const std::string& event) const { return commands_.contains(event); }
  /// The command of a gesture with %path, %x, %y, %z (rounded to 0.1 mm), %event filled in, and %% for %; empty when
  /// nothing is bound or the command asks for an object or a point and there is none.
  std::string command(const Gesture& gesture) const;

 private:
  std::map<std::string, std::string> commands_;
};

}  // namespace render
