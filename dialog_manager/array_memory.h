#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "objdb/result.h"

namespace manager {

/// Memory that a program fills with the numbers of one array and others read (docs/programs.md): three slots, in turn,
/// so that what was announced stays as it is while the next is filled. Sealed against growing and shrinking, its pages
/// there from the start: touching it cannot fail. It goes with the last process that has it open.
class ArrayMemory {
 public:
  static constexpr std::uint64_t slots = 3;

  /// Room for `capacity` numbers a slot. Errors: limit (no memory, no descriptor).
  static objdb::Result<std::shared_ptr<ArrayMemory>> make(std::size_t capacity);
  ~ArrayMemory();
  ArrayMemory(const ArrayMemory&) = delete;
  ArrayMemory& operator=(const ArrayMemory&) = delete;

  /// Where another process opens it.
  std::string path() const;
  std::size_t capacity() const { return capacity_; }
  /// Given once in the life of the manager.
  std::uint64_t serial() const { return serial_; }

  /// The numbers of slot `sequence % slots`, which must be those of this sequence before and after they were copied.
  /// Errors: range (another sequence, too many, a number that is not finite).
  objdb::Result<std::vector<double>> read(std::uint64_t sequence) const;

 private:
  ArrayMemory() = default;

  int file_ = -1;
  std::byte* bytes_ = nullptr;
  std::size_t size_ = 0, capacity_ = 0;
  std::uint64_t serial_ = 0;
};

/// A file in memory with a word in it, by which a program finds out whether it can open what this process has open.
class ArrayProbe {
 public:
  ArrayProbe();
  ~ArrayProbe();
  ArrayProbe(const ArrayProbe&) = delete;
  ArrayProbe& operator=(const ArrayProbe&) = delete;
  /// "PATH,WORD"; "" when there is none.
  const std::string& text() const { return text_; }

 private:
  int file_ = -1;
  std::string text_;
};

}  // namespace manager
