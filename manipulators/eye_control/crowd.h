#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "manipulators/eye_control/gaze.h"

namespace eye {

/// The eyes of many figures. Those that have the same parameters (but for seed and eye distance) and are at the same
/// time sit at one table of eight and are moved together; a figure alone has a table for itself.
class Crowd {
 public:
  using Table = Gazes<8>;

 private:
  struct Company {
    explicit Company(std::shared_ptr<const Parameters> p) : gazes(std::move(p)) {}

    Table gazes;
    std::array<void*, Table::width> guests{};
  };

 public:
  /// Where one pair of eyes sits. Leaves when it is destroyed.
  class Seat {
   public:
    Seat() = default;
    Seat(Seat&& other) noexcept { *this = std::move(other); }
    Seat& operator=(Seat&& other) noexcept;
    ~Seat() { leave(); }

    bool taken() const { return table_ != nullptr; }
    void leave();

    int64_t step() const { return table_->gazes.step(); }
    Aim aim() const { return table_->gazes.aim(lane_); }
    Mode mode() const { return table_->gazes.mode(lane_); }
    double lid() const { return table_->gazes.lid(lane_); }
    Vec2 trust() const { return table_->gazes.trust(lane_); }
    int64_t saccades() const { return table_->gazes.saccades(lane_); }
    Table::State save() const { return table_->gazes.save(lane_); }
    void rest(const Aim& aim, uint64_t seed) { table_->gazes.rest(lane_, aim, seed); }
    bool restore(const Table::State& state, uint64_t seed) { return table_->gazes.restore(lane_, state, seed); }

   private:
    friend class Crowd;
    Company* table_ = nullptr;
    size_t lane_ = 0;
  };

  /// A free seat at a table with these parameters that is at `step`; what it holds is to be put to rest or restored.
  /// `who` is given back to ask for its stimuli.
  Seat seat(const Parameters& parameters, int64_t step, void* who);

  /// Moves everyone to `end`; `meet` says what somebody meets in the next step of a table.
  void advance(int64_t end, const std::function<Stimulus(void* who, const Table& table, size_t lane)>& meet);

 private:
  std::vector<std::unique_ptr<Company>> tables_;
};

}  // namespace eye
