#include "objdb/scene/scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <tsl/robin_set.h>

#include "objdb/database.h"

namespace objdb::scene {

void insert_id(std::vector<ObjectId>& ids, ObjectId id) {
  ids.insert(std::upper_bound(ids.begin(), ids.end(), id), id);
}

void erase_id(std::vector<ObjectId>& ids, ObjectId id) {
  const auto found = std::lower_bound(ids.begin(), ids.end(), id);
  if (found != ids.end() && *found == id) ids.erase(found);
}

Scene::Scene(Database& database)
    : database_(database), node_(database.schema().find("node")), joint_(database.schema().find("joint")) {
  assert(node_->find("world_orientation") == world_orientation && joint_->find("rest") == rest);
}

Transform Scene::local(const Object& object) const {
  const Transform placed = from_pose(std::get<Vec3>(object.value(position)), std::get<Quat>(object.value(orientation)));
  if (!is_joint(object)) return placed;
  const auto& row = std::get<Numbers>(object.value(dh));
  const double turn = std::get<double>(object.value(angle));
  double theta = row[0] + turn;
  // two angles of 1e308 have no sum, but their directions have
  if (!std::isfinite(theta))
    theta = std::remainder(row[0], 2 * std::numbers::pi) + std::remainder(turn, 2 * std::numbers::pi);
  return placed * denavit_hartenberg(theta, row[1], row[2], row[3]);
}

const Transform& Scene::world(const Object& object) {
  if (object.place->current) return object.place->world;
  // up to the first frame that is known, then down again
  std::vector<const Object*> stale;
  for (const Object* each = &object; each != nullptr && !each->place->current;
       each = database_.object(each->place->parent))
    stale.push_back(each);
  for (auto each = stale.rbegin(); each != stale.rend(); ++each) {
    Place& place = *(*each)->place;
    const Object* above = database_.object(place.parent);
    place.world = above == nullptr ? local(**each) : above->place->world * local(**each);
    place.current = true;
  }
  return object.place->world;
}

std::vector<ObjectId> Scene::top_down(std::span<const ObjectId> nodes) const {
  tsl::robin_set<ObjectId> wanted(nodes.begin(), nodes.end()), passed;
  std::vector<ObjectId> out, chain;
  for (const ObjectId node : nodes) {
    // what carries it, as far as that is not yet listed, then down again
    for (ObjectId each = node; each != 0 && passed.insert(each).second; each = database_.object(each)->place->parent)
      chain.push_back(each);
    for (; !chain.empty(); chain.pop_back())
      if (wanted.contains(chain.back())) out.push_back(chain.back());
  }
  return out;
}

std::vector<ObjectId> Scene::carried_by(const std::vector<ObjectId>& nodes) const {
  std::vector<ObjectId> out;
  tsl::robin_set<ObjectId> seen;
  const auto add = [&](const std::vector<ObjectId>& ids) {
    for (const ObjectId id : ids)
      if (seen.insert(id).second) out.push_back(id);
  };
  add(nodes);
  for (std::size_t i = 0; i < out.size(); ++i) add(database_.object(out[i])->place->children);
  return out;
}

ObjectId Scene::carrier(const Object& object, ObjectId reference) const {
  if (reference != 0) return reference;
  for (const Object* above = database_.object(object.parent); above != nullptr; above = database_.object(above->parent))
    if (above->place) return above->id;
  return 0;
}

Status Scene::check_parent(const Object& object, ObjectId wanted) const {
  // a node that carries nothing closes no circle but with itself
  if (object.place->children.empty() && wanted != object.id) return {};
  const ObjectId first = carrier(object, wanted);
  for (const Object* above = database_.object(first); above != nullptr; above = database_.object(above->place->parent))
    if (above == &object)
      return Error{ErrorKind::range,
                   object.path + ".parent: " + std::string(database_.path(first)) +
                       (wanted == 0 ? ", the node above it in its path, moves with " : " moves with ") + object.path +
                       " itself, expected a node outside of what it carries",
                   0};
  return {};
}

const Object* Scene::in_the_way(const Object& object) const {
  if (check_parent(object, 0)) return nullptr;
  // paths alone make no circle: somewhere between the node above and this one there is a reference
  const Object* each = database_.object(carrier(object, 0));
  while (std::get<std::int64_t>(each->value(parent)) == 0) each = database_.object(each->place->parent);
  return each;
}

void Scene::link(Object& object) {
  object.place->parent = carrier(object, static_cast<ObjectId>(std::get<std::int64_t>(object.value(parent))));
  if (Object* above = database_.mutable_object(object.place->parent)) insert_id(above->place->children, object.id);
}

void Scene::unlink(Object& object) {
  if (Object* above = database_.mutable_object(object.place->parent)) erase_id(above->place->children, object.id);
  object.place->parent = 0;
}

void Scene::created(Object& object) {
  if (!object.type->is(*node_)) return;
  if (!object.place) object.place = std::make_unique<Place>();
  object.place->current = false;
  link(object);
}

void Scene::erased(Object& object) {
  if (object.place) unlink(object);
}

void Scene::changed(Object& object, int field) {
  if (!object.place) return;
  if (field == parent) {
    unlink(object);
    link(object);
  } else if (field != position && field != orientation && !(is_joint(object) && (field == dh || field == angle))) {
    return;
  }
  invalidate(object);
}

void Scene::invalidate(Object& object) {
  std::vector<Object*> pending{&object};
  while (!pending.empty()) {
    Object& each = *pending.back();
    pending.pop_back();
    // below a stale frame all frames are stale already
    if (!each.place->current) continue;
    each.place->current = false;
    database_.derived_changed(each, world_position);
    database_.derived_changed(each, world_orientation);
    const auto& children = each.place->children;
    for (auto child = children.rbegin(); child != children.rend(); ++child)
      pending.push_back(database_.mutable_object(*child));
  }
}

}  // namespace objdb::scene
