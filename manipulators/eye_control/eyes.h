#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>

#include "manipulators/eye_control/gaze.h"
#include "manipulators/eye_control/tick_world.h"
#include "manipulators/kit/manipulator.h"

namespace eye {

/// The eyes of a world: one `gaze` object for each pair, moved at every tick in whole milliseconds.
class Eyes {
 public:
  Eyes();
  int run() { return me_.run(); }

 private:
  // where the eyes sit in the head
  struct Sockets {
    const objdb::Object *left, *right, *head;
    Eigen::Vector3d middle;  // between the eyes' centres, in the head's frame
    double distance;
  };
  // what is remembered of one pair
  struct Pair {
    std::unique_ptr<Gaze> gaze;
    TickWorld world;
    bool seeing = false;         // anything in the last tick
    objdb::ObjectId target = 0;  // and which node; 0 is a point
  };
  // what is to be looked at now
  struct Wish {
    bool any = false;
    objdb::ObjectId target = 0;
    Eigen::Vector3d place = Eigen::Vector3d::Zero();
  };

  objdb::Result<std::string> look(objdb::Words words);
  void tick(const kit::Tick& now);
  void move(const objdb::Object& object, Pair& pair, const kit::Tick& now);
  std::string find(const objdb::Object& object, Sockets& sockets);
  const objdb::Object* neck_of(const objdb::Object& object) const;
  Wish wish(const objdb::Object& object);
  std::shared_ptr<const Parameters> parameters(const objdb::Object& object, double eye_distance) const;
  void rest(Pair& pair, const Sockets& sockets, std::shared_ptr<const Parameters> p, const kit::Tick& now);
  void show(const objdb::Object& object, const Pair& pair, const Sockets& sockets, const Wish& wish,
            const HeadPose& head);
  void remember();
  bool recall(const objdb::Object& object, Pair& pair, std::shared_ptr<const Parameters> p);

  kit::Manipulator me_;
  std::map<objdb::ObjectId, Pair> pairs_;
};

}  // namespace eye
