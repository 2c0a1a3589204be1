#pragma once

#include <memory>
#include <string>

#include "manipulators/render/picture.h"

namespace render {

/// Frames on their way into a file: .mp4, .webm or .gif through the program ffmpeg, or a folder of numbered PNGs.
/// Frame k (0, 1 ...) shows the world at simulated time start + (k + 1) / rate, or at the first tick after it, so a
/// film has the same frames at any speed of the machine and a run of one second makes one second of film.
class Movie {
 public:
  /// Starts a film. The encoder runs with one thread and no time stamps of its own, so equal frames give equal files.
  /// Null with `problem` when the size is odd (films need even sides), ffmpeg is missing or the folder cannot be made.
  static std::unique_ptr<Movie> start(const std::string& path, Size size, double rate, double time,
                                      std::string& problem);
  ~Movie();
  Movie(const Movie&) = delete;
  Movie& operator=(const Movie&) = delete;

  /// How many frames are due when simulated time has come to `time`: those with start + (k + 1) / rate <= time.
  int due(double time) const;
  /// Adds a frame. Returns an empty string, or what went wrong (the encoder has ended, the disk is full).
  std::string add(const Picture& picture);
  /// Waits for the encoder. Returns an empty string, or its complaint. The file then is complete.
  std::string finish();

  int frames() const { return frames_; }
  double seconds() const { return frames_ / rate_; }
  const std::string& path() const { return path_; }
  Size size() const { return size_; }

 private:
  Movie() = default;
  std::string path_;
  Size size_;
  double rate_ = 60;
  double start_ = 0;
  int frames_ = 0;
  bool is_folder_ = false;
  int pipe_ = -1;
  int complaints_ = -1;
  int process_ = -1;
};

}  // namespace render
