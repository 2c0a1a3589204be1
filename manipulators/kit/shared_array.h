#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "objdb/array_layout.h"
#include "objdb/numbers.h"

namespace kit {

/// The memory of one array, as the dialog manager made it (docs/programs.md): one program fills it, or the manager and
/// programs read where the numbers stand. It stays as long as somebody holds numbers in it.
class SharedArray : public std::enable_shared_from_this<SharedArray> {
 public:
  /// Opens it to be filled, or only to be read. Null when it cannot be opened, or is none.
  static std::shared_ptr<SharedArray> open(const std::string& path, bool fill);
  ~SharedArray();
  SharedArray(const SharedArray&) = delete;
  SharedArray& operator=(const SharedArray&) = delete;

  std::size_t capacity() const { return capacity_; }

  /// The slot of the next sequence, for `count` numbers, at most capacity(): whoever reads it meanwhile finds none.
  std::span<double> begin(std::size_t count);
  /// The numbers that were put there, where they stand; they stay there until the slot comes up again.
  objdb::Numbers begun() const;
  /// They are whole. The sequence.
  std::uint64_t finish();
  std::uint64_t slot_of(std::uint64_t sequence) const { return sequence % slots_; }
  /// How many can be filled until the first of them is filled again.
  std::size_t slots() const { return slots_; }

  /// The numbers of a sequence, where they stand. Nothing when the slot holds another.
  std::optional<objdb::Numbers> read(std::uint64_t slot, std::uint64_t sequence) const;

 private:
  using Head = objdb::array_layout::Head;
  SharedArray() = default;
  Head* head(std::uint64_t slot) const { return objdb::array_layout::head(bytes_, capacity_, slot); }
  double* numbers(std::uint64_t slot) const { return objdb::array_layout::numbers(bytes_, capacity_, slot); }
  objdb::Numbers view(std::uint64_t slot, std::size_t count) const;

  std::byte* bytes_ = nullptr;
  std::size_t size_ = 0, capacity_ = 0, slots_ = 0;
  std::uint64_t sequence_ = 0;
  std::size_t count_ = 0;  // in the slot that is being filled
};

/// Can this process open what the manager has open? `probe` is "PATH,WORD": the file holds the word.
bool shares_memory(const std::string& probe);

}  // namespace kit
