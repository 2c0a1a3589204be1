#pragma once

#include <string>
#include <utility>
#include <vector>

#include "manipulators/face_fem/action_units.h"
#include "manipulators/face_fem/envelope.h"
#include "manipulators/face_fem/expressions.h"

namespace face {

/// A part of what a face plays: some action units, up, held and down again.
struct Gesture {
  std::string channel;  ///< gestures of one channel follow one another and are added up; channels are blended
  double amount = 1;    ///< 0..1
  Envelope envelope;    ///< times relative to the start of the performance's next tick until it began
  Parts parts;
};

/// What a face plays: gestures that overlap in time. Levels are smooth in time whatever begins and ends when.
///
/// Within a channel (the name of an expression, or speech) a new gesture takes over from the old one: the old one falls
/// while the new one rises, so their sum is the least-jerk course from the old level to the new. Channels are blended
/// as 1 - product of (1 - level), which never passes 1 and is smooth where the greater of both would have a kink.
class Performance {
 public:
  /// Begins at the start of the next tick. Earlier gestures of its channel fall as it rises.
  void begin(Gesture gesture);
  /// Several in one channel, such as the visemes of an utterance, with their own envelopes. Earlier ones of the channel
  /// fall within `offset`.
  void begin_all(std::vector<Gesture> gestures, double offset);
  /// All gestures fall from the start of the next tick, within `offset` seconds each.
  void relax(double offset);

  /// Takes notice of what was begun (the tick starts at `start`) and forgets what is over at `time`. The levels then.
  Levels advance(double start, double time);

  /// "smile 0.8, speech": channels with something to see at the time of the last tick, in order of begin.
  std::string playing() const;
  bool idle() const { return gestures_.empty() && pending_.empty() && !relaxing_; }

  /// All state as a list of words and one of numbers, and back; false when they are no such lists.
  std::pair<std::vector<std::string>, std::vector<double>> memory() const;
  bool recall(const std::vector<std::string>& words, const std::vector<double>& numbers);

 private:
  struct Pending {
    std::vector<Gesture> gestures;
    double offset = 0;  // of the earlier ones in the channel
  };
  void end(Gesture& gesture, double start, double offset);

  std::vector<Gesture> gestures_;  // in order of begin, absolute times
  std::vector<Pending> pending_;   // since the last tick, times from its start
  bool relaxing_ = false;
  double relax_offset_ = 0;
  double time_ = 0;
};

}  // namespace face
