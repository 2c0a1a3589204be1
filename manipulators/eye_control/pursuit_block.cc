#include "manipulators/eye_control/pursuit_block.h"

#include <algorithm>
#include <cmath>

namespace eye {

PursuitBlock::PursuitBlock(const Parameters& p)
    : constants_{p.step,
                 p.pursuit_gain,
                 p.copy_gain,
                 p.local_gain,
                 p.acceleration_limit,
                 p.velocity_limit,
                 Lag(p.plant_time, p.step),
                 Lag(p.copy_plant_time, p.step)},
      delays_{p.steps(p.visual_delay), p.steps(p.copy_visual_delay), p.steps(p.local_delay), p.steps(p.motor_delay),
              p.steps(p.copy_motor_delay)} {
  size_t size = 2;
  while (size < static_cast<size_t>(*std::max_element(delays_.begin(), delays_.end())) + 2) size *= 2;
  past_.resize(size);
  mask_ = size - 1;
}

// wider registers change the speed, not the bits: no operation here is fused or reordered
__attribute__((target_clones("avx512f", "avx2", "default"))) void PursuitBlock::step(const Constants& c, const View& m,
                                                                                     const double* target,
                                                                                     double* position) {
  const double half = 0.5 * c.step, inverse_limit = 1 / c.acceleration_limit;
  for (int i = 0; i < lanes; ++i) {
    const auto k = static_cast<size_t>(i);
    const double seen0 = target[i] + (c.copy_gain * m.copied0->copy[k] - m.seen0->velocity[k]);
    const double seen1 = target[i] + (c.copy_gain * m.copied1->copy[k] - m.seen1->velocity[k]);
    const double limited0 = std::min(std::max(seen0, -c.velocity_limit), c.velocity_limit);
    const double limited1 = std::min(std::max(seen1, -c.velocity_limit), c.velocity_limit);
    const double wanted0 = c.local_gain * (c.pursuit_gain * limited0 - m.local0->command[k]);
    const double wanted1 = c.local_gain * (c.pursuit_gain * limited1 - m.local1->command[k]);
    const double begin = wanted0 / (1 + std::abs(wanted0) * inverse_limit);
    const double end = wanted1 / (1 + std::abs(wanted1) * inverse_limit);
    const double i0 = m.motor0->command[k], i1 = m.motor1->command[k], v0 = m.now->velocity[k];
    const double v1 = c.plant.keep * v0 + c.plant.from * i0 + c.plant.to * i1;
    m.next->command[k] = m.now->command[k] + half * (begin + end);
    m.next->velocity[k] = v1;
    m.next->copy[k] = c.copy_plant.keep * m.now->copy[k] + c.copy_plant.from * m.copy_motor0->command[k] +
                      c.copy_plant.to * m.copy_motor1->command[k];
    position[i] += half * (i0 + i1) - c.plant.time * (v1 - v0);
  }
}

void PursuitBlock::advance(const double* target) {
  const auto at = [&](int64_t n) { return &past_[static_cast<size_t>(n) & mask_]; };
  const auto [visual, copy_visual, local, motor, copy_motor] = delays_;
  const View view{at(n_),
                  at(n_ - visual),
                  at(n_ + 1 - visual),
                  at(n_ - copy_visual),
                  at(n_ + 1 - copy_visual),
                  at(n_ - local),
                  at(n_ + 1 - local),
                  at(n_ - motor),
                  at(n_ + 1 - motor),
                  at(n_ - copy_motor),
                  at(n_ + 1 - copy_motor),
                  at(n_ + 1)};
  step(constants_, view, target, position_.data());
  n_ += 1;
}

}  // namespace eye
