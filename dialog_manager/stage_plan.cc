#include "dialog_manager/stage_plan.h"

#include <algorithm>
#include <iterator>

namespace manager {
namespace {

using namespace objdb;

using Order = std::vector<std::vector<bool>>;  // [writer][reader]: must stand before

// the fields that a derived field is computed from
bool moves_derived(const Type& type, const Field& field) {
  static constexpr std::string_view moving[] = {"parent", "position", "orientation", "dh", "angle"};
  return (type.name() == "node" || type.name() == "joint") &&
         std::find(std::begin(moving), std::end(moving), field.name) != std::end(moving);
}

bool reads_derived(const Declaration& reader, const Database& world) {
  for (const int derived : {scene::Scene::world_position, scene::Scene::world_orientation}) {
    bool delayed = false;
    if (reader.reads_by_name(world.scene().node_type().field(derived), &delayed) && !delayed) return true;
  }
  return false;
}

// does it read the field in the tick in which it is written?
bool reads_at_once(const Declaration& reader, const Database& world, const Type& type, const Field& field) {
  bool delayed = false;
  if (reader.reads(world.schema(), field, &delayed) && !delayed) return true;
  return moves_derived(type, field) && reads_derived(reader, world);
}

Order order_of(const Database& world, const std::vector<StageMember>& members) {
  const std::size_t count = members.size();
  Order before(count, std::vector<bool>(count));
  for (const auto& type : world.schema().types())
    for (const Field* field : type->fields()) {
      if (field->owner != type.get()) continue;
      for (std::size_t w = 0; w < count; ++w) {
        if (!members[w].declared->writes(world.schema(), *field)) continue;
        for (std::size_t r = 0; r < count; ++r)
          // shards of one program stand side by side and see what the others did a tick later
          if (r != w && members[r].program != members[w].program &&
              reads_at_once(*members[r].declared, world, *type, *field))
            before[w][r] = true;
      }
    }
  return before;
}

Error circle(const Order& before, const std::vector<StageMember>& members) {
  std::string names;
  for (std::size_t w = 0; w < members.size(); ++w)
    for (std::size_t r = w + 1; r < members.size(); ++r)
      if (before[w][r] && before[r][w]) names = members[w].name + " and " + members[r].name;
  return {ErrorKind::busy,
          (names.empty() ? "some programs" : names) +
              " each read what the other writes, expected one of the reads to be declared delayed",
          0};
}

}  // namespace

Result<std::vector<int>> plan_stages(const Database& world, const std::vector<StageMember>& members) {
  const std::size_t count = members.size();
  const Order before = order_of(world, members);
  // the stage of a program is the longest way that leads to it; a way longer than all of them goes round
  std::vector<int> stage(count, 0);
  for (std::size_t round = 0; round <= count; ++round) {
    bool moved = false;
    for (std::size_t w = 0; w < count; ++w)
      for (std::size_t r = 0; r < count; ++r)
        if (before[w][r] && stage[r] <= stage[w]) {
          stage[r] = stage[w] + 1;
          moved = true;
        }
    if (!moved) return stage;
  }
  return circle(before, members);
}

}  // namespace manager
