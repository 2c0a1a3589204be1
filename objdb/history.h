#pragma once

#include <cstddef>
#include <deque>
#include <memory>
#include <utility>

namespace objdb {

/// A row of changes: the newest is taken back, the oldest forgotten. They stand in blocks that are used again, so that
/// a world that changes and forgets at every tick touches the same memory each time.
template <class T>
class History {
 public:
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  T& back() { return at(size_ - 1); }

  /// One more, as it was left by whoever used its place before: all of it is to be written.
  T& push() {
    const std::size_t block = (first_ + size_) / block_size;
    if (block == blocks_.size()) blocks_.push_back(spare_ ? std::move(spare_) : std::make_unique<T[]>(block_size));
    return at(size_++);
  }
  void pop_back() {
    --size_;
    if (size_ == 0) first_ = 0;
    // one block beyond the last is kept
    while (blocks_.size() > (first_ + size_) / block_size + 2) blocks_.pop_back();
  }
  void pop_front() {
    --size_;
    if (++first_ < block_size && size_ > 0) return;
    if (first_ == block_size) {
      spare_ = std::move(blocks_.front());
      blocks_.pop_front();
    }
    first_ = 0;
  }
  T& front() { return at(0); }

 private:
  static constexpr std::size_t block_size = 1024;
  T& at(std::size_t index) { return blocks_[(first_ + index) / block_size][(first_ + index) % block_size]; }

  std::deque<std::unique_ptr<T[]>> blocks_;
  std::unique_ptr<T[]> spare_;
  std::size_t first_ = 0;  // in the first block
  std::size_t size_ = 0;
};

}  // namespace objdb
