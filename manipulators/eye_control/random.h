#pragma once

#include <cmath>
#include <cstdint>

#include "manipulators/eye_control/vec2.h"

namespace eye {

/// Which of the model's random sequences; each is independent of how often the others are asked.
enum class Stream : uint64_t { latency, noise, drift, microsaccade, blink };

/// A random number as a pure function of seed, stream and counter (the finaliser of splitmix64), so that the only state
/// is the counter. Uniform in (0, 1).
inline double uniform(uint64_t seed, Stream stream, uint64_t counter) {
  uint64_t z = (seed * 0x9e3779b97f4a7c15u + static_cast<uint64_t>(stream)) * 0xd1342543de82ef95u + counter;
  for (int round = 0; round < 2; ++round) {
    z += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    z ^= z >> 31;
  }
  return (static_cast<double>(z >> 11) + 0.5) * 0x1p-53;
}

/// Standard normal number (Box and Muller); uses the counters 2 n and 2 n + 1.
inline double normal(uint64_t seed, Stream stream, uint64_t n) {
  return std::sqrt(-2 * std::log(uniform(seed, stream, 2 * n))) * std::cos(2 * pi * uniform(seed, stream, 2 * n + 1));
}

}  // namespace eye
