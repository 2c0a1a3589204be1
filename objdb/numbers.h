#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace objdb {

/// Rows from this many numbers on are long: they are hashed at the speed of memory, and go from program to program in
/// shared memory.
constexpr std::size_t long_array = 1024;

/// Numbers that stand somewhere in memory, and whoever keeps them there.
struct NumberBlock {
  explicit NumberBlock(std::span<const double> stand = {}, bool last = true) : numbers(stand), lasting(last) {}
  virtual ~NumberBlock() = default;
  NumberBlock(const NumberBlock&) = delete;
  NumberBlock& operator=(const NumberBlock&) = delete;

  std::span<const double> numbers;
  /// Do they stay as they are for as long as somebody holds the block? If not, a copy of the value copies them.
  bool lasting;
  /// hash_numbers() of them, once somebody asked.
  mutable std::optional<std::uint64_t> hash;
};

/// A row of numbers that never changes: another value is another row. A copy costs nothing, however long it is; so the
/// world, what can be taken back, and what must be told again hold the same numbers. One thread.
class Numbers {
 public:
  Numbers() = default;
  Numbers(std::vector<double> numbers);  // NOLINT(google-explicit-constructor): a vector is a row of numbers
  Numbers(std::initializer_list<double> numbers) : Numbers(std::vector<double>(numbers)) {}
  explicit Numbers(std::shared_ptr<const NumberBlock> block) : block_(std::move(block)) {}
  Numbers(const Numbers& other);
  Numbers(Numbers&& other) noexcept = default;
  Numbers& operator=(const Numbers& other);
  Numbers& operator=(Numbers&& other) noexcept = default;
  ~Numbers() = default;

  std::span<const double> span() const { return block_ ? block_->numbers : std::span<const double>(); }
  operator std::span<const double>() const { return span(); }  // NOLINT(google-explicit-constructor): likewise
  std::size_t size() const { return span().size(); }
  bool empty() const { return size() == 0; }
  const double* data() const { return span().data(); }
  auto begin() const { return span().begin(); }
  auto end() const { return span().end(); }
  double operator[](std::size_t i) const { return span()[i]; }
  /// A copy to be changed.
  std::vector<double> vector() const { return {begin(), end()}; }
  /// Where they stand; null for none.
  const NumberBlock* block() const { return block_.get(); }
  /// hash_numbers() of them, computed once for all copies.
  std::uint64_t hash() const;

  /// The same bits.
  friend bool operator==(const Numbers& a, const Numbers& b);

 private:
  std::shared_ptr<const NumberBlock> block_;
};

/// Is every number finite? At the speed of memory.
bool all_finite(std::span<const double> numbers);

/// 64 bits of numbers, by their bits; the same on every machine and in every build, at the speed of memory.
std::uint64_t hash_numbers(std::span<const double> numbers);

}  // namespace objdb
