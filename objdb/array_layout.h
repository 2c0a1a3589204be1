#pragma once

#include <cstddef>
#include <cstdint>

#include <string_view>

/// How a long array stands in memory that processes share (docs/programs.md): a header, and from the first page on
/// slots, each a head and the numbers. The manager makes such memory, programs open it.
namespace objdb::array_layout {

constexpr std::size_t page = 4096, line = 64;
constexpr std::string_view magic = "sailor_b";

struct Header {
  char magic[8];
  std::uint64_t capacity, slots;
};

/// Of a slot, in a cache line of its own. The sequence is written last: then the slot holds the numbers of it.
struct Head {
  std::uint64_t sequence, count;
};

/// Bytes of a slot with room for `capacity` numbers: whole pages.
constexpr std::size_t stride(std::size_t capacity) {
  return (line + capacity * sizeof(double) + page - 1) / page * page;
}

constexpr std::size_t size(std::size_t capacity, std::size_t slots) { return page + slots * stride(capacity); }

inline Head* head(std::byte* memory, std::size_t capacity, std::size_t slot) {
  return reinterpret_cast<Head*>(memory + page + slot * stride(capacity));
}

inline double* numbers(std::byte* memory, std::size_t capacity, std::size_t slot) {
  return reinterpret_cast<double*>(memory + page + slot * stride(capacity) + line);
}

}  // namespace objdb::array_layout
