#include "manipulators/arm_ik/peers/peers.h"

// peers know turning joints only here
extern "C" std::vector<std::unique_ptr<arm_ik::Peer>> arm_ik_peers(const kinematics::Chain& chain);

std::vector<std::unique_ptr<arm_ik::Peer>> arm_ik_peers(const kinematics::Chain& chain) {
  std::vector<std::unique_ptr<arm_ik::Peer>> out;
  for (const kinematics::Joint& joint : chain.joints) {
    if (joint.kind != kinematics::JointKind::turn) return out;
  }
#ifdef ARM_IK_KDL
  out.push_back(arm_ik::kdl_levenberg(chain));
  out.push_back(arm_ik::kdl_newton(chain));
#endif
#ifdef ARM_IK_DART
  out.push_back(arm_ik::dart_solver(chain));
#endif
#ifdef ARM_IK_MUJOCO
  out.push_back(arm_ik::mujoco_loop(chain));
#endif
  return out;
}
