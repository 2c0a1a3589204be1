#pragma once

#include <string>

namespace manager {

/// What the scene wants: at most this error (m, rad), or this time a tick (s); nothing when neither is said.
struct Budget {
  enum class Of { nothing, error, time } of = Of::nothing;
  double value = 0;
  /// As programs are told.
  std::string line() const;
};

}  // namespace manager
