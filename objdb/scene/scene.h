#pragma once

#include "objdb/object.h"

namespace objdb {
class Database;
}

namespace objdb::scene {

/// Puts a number into a rising list, takes it out again.
void insert_id(std::vector<ObjectId>& ids, ObjectId id);
void erase_id(std::vector<ObjectId>& ids, ObjectId id);

/// The tree of frames over the nodes of a database. A node's parent is its `parent` field or, without one, the nearest
/// node above it in its path. World transforms are computed when asked for and kept until something above them
/// changes: the cost is in proportion to what changed and is asked for.
class Scene {
 public:
  /// Indices of the built-in fields, the same in every type that extends node (joint).
  enum NodeField { parent, position, orientation, scale, visible, world_position, world_orientation };
  enum JointField { dh = 7, angle, lower, upper, rest };

  explicit Scene(Database& database);

  const Type& node_type() const { return *node_; }
  const Type& joint_type() const { return *joint_; }

  /// X_W of a node's frame.
  const Transform& world(const Object& object);
  /// X of the node's frame in its parent's frame.
  Transform local(const Object& object) const;
  /// The node it moves with, 0 at the top.
  ObjectId parent_of(const Object& object) const { return object.place->parent; }

  /// The same nodes, none before a node that carries it. Cost in proportion to the nodes and what carries them.
  std::vector<ObjectId> top_down(std::span<const ObjectId> nodes) const;
  /// These nodes and all that they carry, each once.
  std::vector<ObjectId> carried_by(const std::vector<ObjectId>& nodes) const;

  /// Would `parent` (0: the node above it in its path) as the parent of `object` close a circle? Error range.
  Status check_parent(const Object& object, ObjectId parent) const;
  /// The first node whose parent reference must be emptied before that of `object` can be, or null.
  const Object* in_the_way(const Object& object) const;

  // told by the database
  void created(Object& object);
  void erased(Object& object);
  void changed(Object& object, int field);

 private:
  ObjectId carrier(const Object& object, ObjectId reference) const;
  void link(Object& object);
  void unlink(Object& object);
  void invalidate(Object& object);
  bool is_joint(const Object& object) const { return object.type->is(*joint_); }

  Database& database_;
  const Type* node_;
  const Type* joint_;
};

}  // namespace objdb::scene
