#pragma once

#include <string>

namespace render {

/// A voice of its own in the dialog: a FIFO that the dialog manager listens to, so that what a person does at the
/// window is said by a source with a name, like everybody else's lines.
class Speaker {
 public:
  /// Makes the FIFO `window` in a new private folder. An empty path() means that it could not be made.
  Speaker();
  ~Speaker();
  Speaker(const Speaker&) = delete;
  Speaker& operator=(const Speaker&) = delete;

  const std::string& path() const { return path_; }
  /// Says a line, without its newline. False when nobody listens, the FIFO is full, or the line is longer than what a
  /// FIFO takes whole (4096 bytes).
  bool say(const std::string& line);

 private:
  std::string folder_, path_;
  int pipe_ = -1;
};

}  // namespace render
