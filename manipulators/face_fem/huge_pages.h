#pragma once

#include <sys/mman.h>

#include <cstdlib>
#include <new>
#include <utility>
#include <vector>

namespace face {

/// Allocator for large arrays that are written once in full: memory in pages of 2 MB where the system grants them
/// (a factor of 60 MB would else take 15 000 page faults), and elements that are not zeroed first.
template <class T>
struct HugePages {
  using value_type = T;
  static constexpr std::size_t page = std::size_t(1) << 21;

  HugePages() = default;
  template <class U>
  HugePages(const HugePages<U>&) {}

  T* allocate(std::size_t count) {
    const std::size_t bytes = count * sizeof(T);
    const bool large = bytes >= page;
    void* memory =
        std::aligned_alloc(large ? page : 64, large ? (bytes + page - 1) / page * page : (bytes + 63) / 64 * 64);
    if (memory == nullptr) throw std::bad_alloc();
    if (large) madvise(memory, bytes, MADV_HUGEPAGE);
    return static_cast<T*>(memory);
  }
  void deallocate(T* memory, std::size_t) { std::free(memory); }

  // resize(n) leaves elements as they are; assign and copies write them
  template <class U>
  void construct(U* place) {
    ::new (static_cast<void*>(place)) U;
  }
  template <class U, class... Arguments>
  void construct(U* place, Arguments&&... arguments) {
    ::new (static_cast<void*>(place)) U(std::forward<Arguments>(arguments)...);
  }

  template <class U>
  bool operator==(const HugePages<U>&) const {
    return true;
  }
};

template <class T>
using HugeArray = std::vector<T, HugePages<T>>;

}  // namespace face
