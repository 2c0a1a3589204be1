#pragma once

#include <string>
#include <vector>

#include "dialog_manager/declaration.h"
#include "objdb/database.h"

namespace manager {

/// One who takes part in ticks, as the plan sees it.
struct StageMember {
  std::string name, program;  ///< members of one program are its shards: they stand side by side
  const Declaration* declared;
};

/// The stage of each member, from 0: a writer stands before its readers, each as early as can be. A delayed read sees
/// the tick before, and orders nothing. Error busy when they form a circle.
objdb::Result<std::vector<int>> plan_stages(const objdb::Database& world, const std::vector<StageMember>& members);

}  // namespace manager
