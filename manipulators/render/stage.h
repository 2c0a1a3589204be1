#pragma once

#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "manipulators/render/scene.h"
#include "manipulators/render/skins.h"
#include "objdb/database.h"

namespace render {

/// Where nodes have been: positions by time, kept for the nodes that some view wants.
class Trails {
 public:
  struct Point {
    double time;
    Eigen::Vector3f position;
  };
  /// Notes where the wanted nodes are now. Points older than the longest wish are dropped; a step back in time forgets.
  void record(const objdb::Database& world, double time);
  /// Oldest first; empty for nodes nobody asked for.
  const std::deque<Point>& of(objdb::ObjectId node) const;

 private:
  std::map<objdb::ObjectId, std::deque<Point>> ways_;
};

/// Turns a world into what is to be drawn. Keeps what is costly to make between calls.
class Stage {
 public:
  /// The scene as `view` shows it at `time`; a null view shows the plain world.
  Scene compose(const objdb::Database& world, const objdb::Object* view, double time);

  /// What became of meshes and skins in the last compose().
  const std::vector<Report>& reports() const { return reports_; }
  Trails& trails() { return trails_; }
  const Skins& skins() const { return skins_; }

 private:
  bool visible(const objdb::Database& world, const objdb::Object& node);
  void add_shape(const objdb::Database& world, const objdb::Object& object, float skin_opacity, Scene& scene);
  void add_eyeball(const objdb::Database& world, const objdb::Object& object, Scene& scene);
  void add_carried(const objdb::Database& world, Scene& scene);
  void add_lights(const objdb::Database& world, Scene& scene);
  GeometryPointer capsule_of(const objdb::Object& object);

  Skins skins_;
  Trails trails_;
  std::vector<Report> reports_;
  std::map<std::pair<double, double>, GeometryPointer> capsules_;
  std::vector<signed char> visible_;  // by object number: 0 unknown, 1 yes, -1 no
};

/// The camera a `camera` object stands for.
Camera camera_of(const objdb::Database& world, const objdb::Object& object);

/// A camera in front of everything that is not scenery, a little above and to the side, far enough to see it all.
Camera camera_for(const Scene& scene, float aspect);

/// The camera that `view` names, or the first one, or null.
const objdb::Object* chosen_camera(const objdb::Database& world, const objdb::Object* view);

/// The path of a closed drawable that the camera stands in, empty for none: rays from the camera must leave it.
std::string solid_around(const Scene& scene, const Camera& camera);

}  // namespace render
