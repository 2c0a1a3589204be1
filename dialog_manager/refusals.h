#pragma once

#include <cstdint>

namespace manager {

/// Lines of a program that were refused, and when that is enough.
class Refusals {
 public:
  void refused() {
    ++all_;
    ++in_a_row_;
  }
  /// Something that it said was right.
  void accepted() { in_a_row_ = 0; }
  /// Another life of it begins.
  void forgive() { in_a_row_ = 0; }

  std::uint64_t all() const { return all_; }
  /// Are more of them worth telling a person?
  bool worth_telling() const { return in_a_row_ <= told; }
  /// What it says is garbage.
  bool too_many() const { return in_a_row_ >= allowed; }

 private:
  static constexpr int told = 20, allowed = 100;
  std::uint64_t all_ = 0;
  int in_a_row_ = 0;
};

}  // namespace manager
