#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "manipulators/face_fem/performance.h"

namespace face {

/// An utterance as gestures of one channel, from words of visemes: `m a m a`, a word may carry its length (`a=250ms`).
/// Co-articulation is the simple kind: while one viseme fades the next one grows, along the same least-jerk course,
/// over `blend` of the shorter of both, so that the levels of neighbours sum to 1 and each is reached in full in its
/// middle (lips that must close, close). `length`: of a viseme without its own, seconds. Times are relative to the
/// start. Errors: syntax (nothing to say), unknown (no viseme, did you mean), range (length not positive).
objdb::Result<std::vector<Gesture>> utterance(std::span<const std::string_view> words, double length, double amount,
                                              double blend = 0.8);

}  // namespace face
