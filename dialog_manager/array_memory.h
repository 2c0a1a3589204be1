#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "objdb/array_layout.h"
#include "objdb/result.h"

namespace manager {

/// Memory that processes share, in slots that hold one array each (docs/programs.md). Sealed against growing and
/// shrinking, its pages there from the start: touching it cannot fail. It goes with the last process that has it open.
class ArrayMemory {
 public:
  /// Who writes it: the program that it is given to, or the manager alone. What is the manager's nobody else can map
  /// to write, the kernel sees to that.
  enum class Writer { program, manager };

  using Head = objdb::array_layout::Head;

  /// `slots` slots with room for `capacity` numbers each. Errors: limit (no memory, no descriptor).
  static objdb::Result<std::shared_ptr<ArrayMemory>> make(std::size_t capacity, std::size_t slots, Writer writer);
  ~ArrayMemory();
  ArrayMemory(const ArrayMemory&) = delete;
  ArrayMemory& operator=(const ArrayMemory&) = delete;

  /// Where another process opens it.
  std::string path() const;
  std::size_t capacity() const { return capacity_; }
  std::size_t slots() const { return slots_; }
  /// Given once in the life of the manager.
  std::uint64_t serial() const { return serial_; }

  Head* head(std::size_t slot) const { return objdb::array_layout::head(bytes_, capacity_, slot); }
  double* numbers(std::size_t slot) const { return objdb::array_layout::numbers(bytes_, capacity_, slot); }

 private:
  ArrayMemory() = default;

  int file_ = -1;
  std::byte* bytes_ = nullptr;
  std::size_t size_ = 0, capacity_ = 0, slots_ = 0;
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
