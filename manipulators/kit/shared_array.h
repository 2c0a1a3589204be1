#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace kit {

/// The memory of one array, as the dialog manager made it (docs/programs.md): one program fills it, others read.
class SharedArray {
 public:
  /// Opens it to be filled, or only to be read. Null when it cannot be opened, or is none.
  static std::unique_ptr<SharedArray> open(const std::string& path, bool fill);
  ~SharedArray();
  SharedArray(const SharedArray&) = delete;
  SharedArray& operator=(const SharedArray&) = delete;

  std::size_t capacity() const { return capacity_; }
  /// Puts the numbers, at most capacity(), into the slot of the next sequence, which is returned.
  std::uint64_t fill(std::span<const double> numbers);
  static std::uint64_t slot_of(std::uint64_t sequence) { return sequence % slots; }
  /// The numbers of a sequence. False when the slot holds another, before or after they were copied.
  bool read(std::uint64_t sequence, std::vector<double>& numbers) const;

 private:
  static constexpr std::uint64_t slots = 3;
  SharedArray() = default;

  std::byte* bytes_ = nullptr;
  std::size_t size_ = 0, capacity_ = 0;
  std::uint64_t sequence_ = 0;
};

/// Can this process open what the manager has open? `probe` is "PATH,WORD": the file holds the word.
bool shares_memory(const std::string& probe);

}  // namespace kit
