#pragma once

#include <string>
#include <variant>
#include <vector>

#include "manipulators/kinematics/chain.h"
#include "objdb/database.h"

namespace arm_ik {

/// A chain found among the objects of a world.
struct FigureChain {
  kinematics::Chain chain;              ///< in the frame of its root
  std::vector<objdb::ObjectId> joints;  ///< one an entry of chain.joints
};

/// The joints that carry `tip` below `root` (null: below the top of the world): walked from the tip upwards by parent;
/// a joint is a freedom, every other node between is a constant transform. Or the sentence that says why there is none.
std::variant<FigureChain, std::string> find_chain(objdb::Database& world, const objdb::Object* root,
                                                  const objdb::Object& tip);

/// The numbers that the chain is made of: while they stay, it stays. Empty when tip does not stand below root.
std::vector<double> fingerprint(objdb::Database& world, const objdb::Object* root, const objdb::Object& tip);

}  // namespace arm_ik
