#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>

namespace manager {

/// Lines of a program that were refused, and when that is enough: 100 in a row, or 1000 in 10 s.
class Refusals {
 public:
  using Time = std::chrono::steady_clock::time_point;

  void refused(Time now) {
    ++all_;
    ++in_a_row_;
    while (!lately_.empty() && now - lately_.front() > window) lately_.pop_front();
    lately_.push_back(now);
  }
  /// Something that it said was right.
  void accepted() { in_a_row_ = 0; }
  /// Another life of it begins.
  void forgive() {
    in_a_row_ = 0;
    lately_.clear();
  }

  std::uint64_t all() const { return all_; }
  /// Are more of them worth telling a person?
  bool worth_telling() const { return in_a_row_ <= told; }
  /// What it says is garbage.
  bool too_many() const { return in_a_row_ >= allowed_in_a_row || lately_.size() >= allowed_lately; }

 private:
  static constexpr int told = 20, allowed_in_a_row = 100;
  static constexpr std::size_t allowed_lately = 1000;
  static constexpr auto window = std::chrono::seconds(10);

  std::uint64_t all_ = 0;
  int in_a_row_ = 0;
  std::deque<Time> lately_;
};

}  // namespace manager
