#include "dialog_manager/channel/line_buffer.h"

#include <algorithm>
#include <cstring>

namespace channel {

char* LineBuffer::room(std::size_t bytes) {
  if (begin_ == end_) begin_ = end_ = searched_ = 0;
  if (bytes_.size() - end_ < bytes) {
    // what was read makes room first
    std::memmove(bytes_.data(), bytes_.data() + begin_, end_ - begin_);
    searched_ -= std::min(searched_, begin_);
    end_ -= begin_;
    begin_ = 0;
    if (bytes_.size() - end_ < bytes) bytes_.resize(end_ + bytes);
  }
  return bytes_.data() + end_;
}

bool LineBuffer::has_line() const {
  const std::size_t from = std::max(begin_, searched_);
  if (std::memchr(bytes_.data() + from, '\n', end_ - from) != nullptr) return true;
  searched_ = end_;
  return end_ - begin_ >= longest_;
}

LineBuffer::Next LineBuffer::next(std::string_view& line) {
  while (true) {
    const std::size_t from = std::max(begin_, searched_);
    const char* found =
        end_ == from ? nullptr : static_cast<const char*>(std::memchr(bytes_.data() + from, '\n', end_ - from));
    if (found != nullptr) {
      const auto newline = static_cast<std::size_t>(found - bytes_.data());
      line = std::string_view(bytes_).substr(begin_, newline - begin_);
      begin_ = searched_ = newline + 1;
      if (skipping_) {
        skipping_ = false;
        continue;
      }
      return line.size() + 1 > longest_ ? Next::too_long : Next::line;
    }
    searched_ = end_;
    if (skipping_) {
      begin_ = end_;
    } else if (end_ - begin_ >= longest_) {
      line = std::string_view(bytes_).substr(begin_, end_ - begin_);
      begin_ = end_;
      skipping_ = true;
      return Next::too_long;
    }
    if (!closed_) return Next::none;
    if (begin_ == end_) return Next::end;
    line = std::string_view(bytes_).substr(begin_, end_ - begin_);
    begin_ = end_;
    return Next::half;
  }
}

}  // namespace channel
