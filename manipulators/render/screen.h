#pragma once

#include <memory>
#include <string>
#include <vector>

#include "manipulators/render/picture.h"

namespace render {

/// Something that happened at a window.
struct ScreenEvent {
  enum class Kind { key, press, release, motion, resize, close, expose } kind;
  std::string name;       ///< key: X's name of it; press, release: Button1 ... Button3, Wheel-up, Wheel-down
  std::string modifiers;  ///< "Shift-Control-Alt-" of those held
  float x = 0, y = 0;     ///< pointer, pixels from the upper left corner
  Size size;              ///< resize: the new one
  bool button[4] = {false, false, false, false};  ///< motion: which buttons are held, by number
};

/// An X11 window that pictures are put into, through shared memory where the server has it (MIT-SHM). One thread.
class Screen {
 public:
  static std::unique_ptr<Screen> open(Size size, const std::string& title, std::string& problem);
  virtual ~Screen() = default;
  /// Waits until the server or `wake` has something to say, or `milliseconds` have passed (-1: forever); then returns
  /// what happened. Motions are merged to the latest.
  virtual std::vector<ScreenEvent> events(int wake, int milliseconds) = 0;
  /// Puts a picture into the upper left corner.
  virtual void put(const Picture& picture) = 0;
  /// False once the server is gone; everything else then does nothing.
  virtual bool alive() const = 0;
};

}  // namespace render
