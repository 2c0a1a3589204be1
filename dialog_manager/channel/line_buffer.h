#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace channel {

/// Bytes that have arrived and the lines in them. Memory stays flat whatever arrives: a line longer than the limit is
/// reported once, skipped to its newline, and the next line is read.
class LineBuffer {
 public:
  /// `longest` counts a line's newline.
  explicit LineBuffer(std::size_t longest) : longest_(longest) {}

  /// Room for at least `bytes` more; fill() says how many were put there. Invalidates lines given out before.
  char* room(std::size_t bytes);
  void fill(std::size_t bytes) { end_ += bytes; }
  /// Nothing more will come.
  void close() { closed_ = true; }
  bool closed() const { return closed_; }

  enum class Next {
    line,      ///< a whole line, without its newline
    none,      ///< no whole line yet
    too_long,  ///< a line beyond the limit stood here; its beginning is given
    half,      ///< the end came in mid-line; given once
    end,       ///< the end
  };
  Next next(std::string_view& line);

  /// Is there, for sure, more to take with next()?
  bool has_line() const;
  std::size_t pending() const { return end_ - begin_; }
  /// What has arrived and was not given out yet.
  std::string_view rest() const { return std::string_view(bytes_).substr(begin_, end_ - begin_); }

 private:
  std::string bytes_;
  std::size_t begin_ = 0, end_ = 0;
  mutable std::size_t searched_ = 0;  // no newline in [begin_, searched_)
  std::size_t longest_;
  bool closed_ = false;
  bool skipping_ = false;  // within a line that is too long
};

}  // namespace channel
