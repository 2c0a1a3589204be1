#include "manipulators/eye_control/crowd.h"

#include <algorithm>
#include <utility>

namespace eye {

namespace {

// what those at one table have in common
Parameters common(Parameters p) {
  p.seed = Parameters().seed;
  p.eye_distance = Parameters().eye_distance;
  return p;
}

}  // namespace

Crowd::Seat& Crowd::Seat::operator=(Seat&& other) noexcept {
  if (this == &other) return *this;
  leave();
  table_ = std::exchange(other.table_, nullptr);
  lane_ = other.lane_;
  return *this;
}

void Crowd::Seat::leave() {
  if (table_ != nullptr) table_->guests[lane_] = nullptr;
  table_ = nullptr;
}

Crowd::Seat Crowd::seat(const Parameters& parameters, int64_t step, void* who) {
  const Parameters wanted = common(parameters);
  Seat seat;
  const auto sit = [&](Company& table) {
    const auto free = std::find(table.guests.begin(), table.guests.end(), nullptr);
    if (free == table.guests.end() || table.gazes.step() != step || !(table.gazes.parameters() == wanted)) return false;
    *free = who;
    seat.table_ = &table;
    seat.lane_ = static_cast<size_t>(free - table.guests.begin());
    return true;
  };
  for (const auto& table : tables_) {
    if (sit(*table)) return seat;
  }
  tables_.push_back(std::make_unique<Company>(std::make_shared<Parameters>(wanted)));
  tables_.back()->gazes.start(step);
  for (size_t lane = 0; lane < Table::width; ++lane) tables_.back()->gazes.rest(lane, {}, 0);
  sit(*tables_.back());
  return seat;
}

void Crowd::advance(int64_t end, const std::function<Stimulus(void*, const Table&, size_t)>& meet) {
  // tables that everybody has left are cleared away
  std::erase_if(tables_, [](const auto& table) {
    return std::all_of(table->guests.begin(), table->guests.end(), [](void* guest) { return guest == nullptr; });
  });
  std::array<Stimulus, Table::width> stimuli;
  for (const auto& table : tables_) {
    while (table->gazes.step() < end) {
      for (size_t lane = 0; lane < Table::width; ++lane) {
        stimuli[lane] = table->guests[lane] == nullptr ? Stimulus{} : meet(table->guests[lane], table->gazes, lane);
      }
      table->gazes.advance(stimuli.data());
    }
  }
}

}  // namespace eye
