#include "manipulators/arm_ik/solution.h"

#include <array>

namespace arm_ik {

namespace {

constexpr std::array<std::string_view, 5> status_words = {"reached", "moving", "limited", "unreachable", "budget"};
constexpr std::array<std::string_view, 7> words = {"auto", "limb", "rhythm", "full", "reach", "polish", "clamped"};

}  // namespace

std::string_view name_of(Status status) { return status_words[static_cast<std::size_t>(status)]; }

std::string_view name_of(Method method) { return words[static_cast<std::size_t>(method)]; }

bool method_named(std::string_view word, Method& out) {
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i] != word) continue;
    out = static_cast<Method>(i);
    return true;
  }
  return false;
}

std::string method_words() {
  std::string out;
  for (std::string_view word : words) out += (out.empty() ? "" : " ") + std::string(word);
  return out;
}

}  // namespace arm_ik
