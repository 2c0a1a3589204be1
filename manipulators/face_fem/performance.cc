#include "manipulators/face_fem/performance.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "objdb/text.h"

namespace face {

void Performance::begin(Gesture gesture) {
  const double offset = gesture.envelope.onset;
  std::vector<Gesture> one;
  one.push_back(std::move(gesture));
  begin_all(std::move(one), offset);
}

void Performance::begin_all(std::vector<Gesture> gestures, double offset) {
  if (gestures.empty()) return;
  // of two said between the same ticks, the later one counts
  std::erase_if(pending_, [&](const Pending& other) { return other.gestures[0].channel == gestures[0].channel; });
  pending_.push_back({std::move(gestures), offset});
}

void Performance::relax(double offset) {
  pending_.clear();
  relaxing_ = true;
  relax_offset_ = offset;
}

// a gesture that is falling already is not made slower
void Performance::end(Gesture& gesture, double start, double offset) {
  Envelope& e = gesture.envelope;
  if (e.end != Envelope::held && e.end + e.offset <= start + offset) return;
  if (e.end != Envelope::held && e.end < start) return;
  e.end = start;
  e.offset = offset;
}

Levels Performance::advance(double start, double time) {
  if (relaxing_)
    for (Gesture& gesture : gestures_) end(gesture, start, relax_offset_);
  relaxing_ = false;
  for (Pending& fresh : pending_) {
    for (Gesture& old : gestures_)
      if (old.channel == fresh.gestures[0].channel) end(old, start, fresh.offset);
    for (Gesture& gesture : fresh.gestures) {
      gesture.envelope.begin += start;
      if (gesture.envelope.end != Envelope::held) gesture.envelope.end += start;
      gestures_.push_back(std::move(gesture));
    }
  }
  pending_.clear();
  time_ = time;
  std::erase_if(gestures_, [&](const Gesture& gesture) { return gesture.envelope.over(time); });

  std::map<std::string_view, Levels> channels;
  for (const Gesture& gesture : gestures_) {
    Levels& sum = channels.try_emplace(gesture.channel, Levels{}).first->second;
    const double level = gesture.amount * gesture.envelope.at(time);
    for (const auto& [place, part] : gesture.parts) sum[std::size_t(place)] += level * part;
  }
  Levels levels{};
  for (const auto& [name, sum] : channels)
    for (std::size_t p = 0; p < levels.size(); ++p)
      levels[p] = 1 - (1 - levels[p]) * (1 - std::clamp(sum[p], 0.0, 1.0));
  return levels;
}

std::string Performance::playing() const {
  std::vector<std::pair<std::string_view, double>> channels;
  for (const Gesture& gesture : gestures_) {
    const double level = gesture.amount * gesture.envelope.at(time_);
    const auto same = std::find_if(channels.begin(), channels.end(),
                                   [&](const auto& channel) { return channel.first == gesture.channel; });
    if (same == channels.end())
      channels.emplace_back(gesture.channel, level);
    else
      same->second += level;
  }
  std::string text;
  for (const auto& [name, level] : channels) {
    if (level < 0.005) continue;
    text += (text.empty() ? "" : ", ") + std::string(name) + " " + objdb::number(std::round(100 * level) / 100);
  }
  return text;
}

// -- memory: numbers are time, whether it is falling and how fast, then the gestures that run, then those that will

namespace {

void write(const Gesture& gesture, std::vector<std::string>& words, std::vector<double>& numbers) {
  words.push_back(gesture.channel);
  const Envelope& e = gesture.envelope;
  numbers.insert(numbers.end(), {gesture.amount, e.begin, e.onset, e.end, e.offset, double(gesture.parts.size())});
  for (const auto& [place, part] : gesture.parts) numbers.insert(numbers.end(), {double(place), part});
}

// reads what write() wrote, never beyond the end
class Reader {
 public:
  Reader(const std::vector<std::string>& words, const std::vector<double>& numbers)
      : words_(words), numbers_(numbers) {}

  double number() { return n_ < numbers_.size() ? numbers_[n_++] : (good_ = false, 0.0); }
  std::size_t count() {
    const double value = number();
    if (!(value >= 0 && value <= double(numbers_.size()))) good_ = false;
    return good_ ? std::size_t(value) : 0;
  }
  Gesture gesture() {
    Gesture gesture;
    good_ = good_ && w_ < words_.size();
    if (!good_) return gesture;
    gesture.channel = words_[w_++];
    Envelope& e = gesture.envelope;
    for (double* value : {&gesture.amount, &e.begin, &e.onset, &e.end, &e.offset}) *value = number();
    const std::size_t parts = count();
    for (std::size_t k = 0; k < parts && good_; ++k) {
      const double place = number(), part = number();
      good_ = good_ && place >= 0 && place < double(std::tuple_size_v<Levels>);
      if (good_) gesture.parts.emplace_back(int(place), part);
    }
    return gesture;
  }
  bool good() const { return good_; }
  bool at_end() const { return good_ && n_ == numbers_.size() && w_ == words_.size(); }

 private:
  const std::vector<std::string>& words_;
  const std::vector<double>& numbers_;
  std::size_t w_ = 0, n_ = 0;
  bool good_ = true;
};

}  // namespace

std::pair<std::vector<std::string>, std::vector<double>> Performance::memory() const {
  std::vector<std::string> words;
  std::vector<double> numbers{time_, double(relaxing_), relax_offset_, double(gestures_.size())};
  for (const Gesture& gesture : gestures_) write(gesture, words, numbers);
  numbers.push_back(double(pending_.size()));
  for (const Pending& pending : pending_) {
    numbers.insert(numbers.end(), {pending.offset, double(pending.gestures.size())});
    for (const Gesture& gesture : pending.gestures) write(gesture, words, numbers);
  }
  return {words, numbers};
}

bool Performance::recall(const std::vector<std::string>& words, const std::vector<double>& numbers) {
  Reader read(words, numbers);
  Performance fresh;
  fresh.time_ = read.number();
  fresh.relaxing_ = read.number() != 0;
  fresh.relax_offset_ = read.number();
  for (std::size_t k = read.count(); k > 0 && read.good(); --k) fresh.gestures_.push_back(read.gesture());
  for (std::size_t k = read.count(); k > 0 && read.good(); --k) {
    Pending pending;
    pending.offset = read.number();
    for (std::size_t g = read.count(); g > 0 && read.good(); --g) pending.gestures.push_back(read.gesture());
    if (pending.gestures.empty()) return false;
    fresh.pending_.push_back(std::move(pending));
  }
  if (!read.at_end()) return false;
  *this = std::move(fresh);
  return true;
}

}  // namespace face
