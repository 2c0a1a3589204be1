#include "manipulators/render/faces.h"

#include <algorithm>

#include "manipulators/render/look.h"

namespace render {

using objdb::Object;

Faces::Change Faces::look(const objdb::Database& world, const Object& surface, const mesh::Origin& origin) {
  Change change = Change::none;
  std::vector<One> now;
  for (const Object* face : all_of(world, "face")) {
    if (object_of(world, *face, "skin") != &surface) continue;
    const auto known = std::find_if(faces_.begin(), faces_.end(), [&](const One& one) { return one.face == face->id; });
    One one = known == faces_.end() ? One{face->id, 0, 0, {}, {}, {}} : std::move(*known);
    const bool is_new = known == faces_.end();

    const std::uint64_t vertices = hash_of(*face, {"vertices"});
    if (is_new || vertices != one.vertices) {
      change = Change::others;
      one.vertices = vertices;
      one.follower.reset();
      one.problem.clear();
      const objdb::Value* value = value_of(*face, "vertices");
      const auto* numbers = value ? std::get_if<std::vector<std::int64_t>>(value) : nullptr;
      auto follower = mesh::Follower::of(origin, numbers ? *numbers : std::vector<std::int64_t>());
      if (follower) {
        one.follower = std::move(*follower);
      } else {
        one.problem = face->path + ": " + follower.error().sentence;
      }
    }
    const std::uint64_t displacement = hash_of(*face, {"displacement"});
    if (is_new || displacement != one.displacement || change == Change::others) {
      one.displacement = displacement;
      if (change == Change::none) change = Change::displaced;
      const objdb::Numbers* by = numbers_of(*face, "displacement");
      const std::size_t wanted = 3 * (one.follower ? one.follower->moved() : 0);
      one.by.clear();
      if (by && by->size() == wanted) one.by.assign(by->begin(), by->end());
      if (one.follower) {
        // before its program has spoken a face has no displacements: it is at rest
        const bool fits = !by || by->empty() || by->size() == wanted;
        one.problem = fits ? ""
                           : face->path + ": displacement has " + std::to_string(by->size() / 3) + " vectors for " +
                                 std::to_string(wanted / 3) + " vertices";
      }
    }
    now.push_back(std::move(one));
  }
  if (now.size() != faces_.size()) change = Change::others;
  faces_ = std::move(now);
  problem_.clear();
  for (const One& one : faces_) {
    if (problem_.empty()) problem_ = one.problem;
  }
  return change;
}

void Faces::add(Eigen::MatrixX3f& V) const {
  for (const One& one : faces_) {
    if (one.follower && !one.by.empty()) one.follower->add(one.by.data(), V);
  }
}

std::vector<int> Faces::vertices() const {
  std::vector<int> all;
  for (const One& one : faces_) {
    if (one.follower) all.insert(all.end(), one.follower->vertices().begin(), one.follower->vertices().end());
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

}  // namespace render
