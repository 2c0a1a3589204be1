#include "manipulators/eye_control/pursuit_block.h"

#include <gtest/gtest.h>

#include <cmath>

#include "manipulators/eye_control/memory.h"
#include "manipulators/eye_control/pursuit.h"

namespace eye::test {
namespace {

TEST(PursuitBlock, EveryLaneIsPursuit) {
  Parameters p;
  p.offset_switch = 0;
  p.predictor = 0;
  PursuitBlock block(p);
  for (int lane = 0; lane < PursuitBlock::lanes; ++lane) {
    Pursuit pursuit(p);
    Memory memory(pursuit.span());
    PursuitBlock alone(p);
    double target[PursuitBlock::lanes] = {}, position = 0;
    for (int n = 0; n < 1500; ++n) {
      target[lane] = n < 200 ? 0 : 0.1 * (lane - 7) * std::cos(0.004 * n);
      alone.advance(target);
      position += pursuit.advance(memory, n, {target[lane], 0}, {}, {}, true).x;
      // x / (1 + x / limit) is divided once in one and by a reciprocal in the other: rounding only
      ASSERT_NEAR(alone.velocity()[static_cast<size_t>(lane)], memory[n + 1].velocity.x, 1e-12) << lane << " " << n;
    }
    EXPECT_NEAR(alone.position()[static_cast<size_t>(lane)], position, 1e-12);
  }
}

}  // namespace
}  // namespace eye::test
