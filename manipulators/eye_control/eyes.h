#pragma once

#include <map>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "manipulators/eye_control/crowd.h"
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
  // what is to be looked at now
  struct Wish {
    bool any = false;
    objdb::ObjectId target = 0;
    Eigen::Vector3d place = Eigen::Vector3d::Zero();
  };
  // what is remembered of one pair
  struct Pair {
    Crowd::Seat seat;
    Parameters parameters;
    TickWorld world;
    Sighting sighting;
    bool seeing = false;         // anything in the last tick
    objdb::ObjectId target = 0;  // and which node; 0 is a point
    // of this tick
    const objdb::Object* object = nullptr;
    Sockets sockets{};
    HeadPose head;
    Wish wish;
  };

  objdb::Result<std::string> look(objdb::Words words);
  void tick(const kit::Tick& now);
  bool prepare(const objdb::Object& object, Pair& pair, const kit::Tick& now);
  Method chosen(std::size_t figures, double step) const;
  std::string find(const objdb::Object& object, Sockets& sockets);
  const objdb::Object* neck_of(const objdb::Object& object);
  Wish wish(const objdb::Object& object);
  Parameters parameters(const objdb::Object& object, double eye_distance);
  void sit(Pair& pair, const Parameters& p, const kit::Tick& now);
  void rest(Pair& pair, const kit::Tick& now);
  void show(const Pair& pair);
  void remember();
  bool recall(Pair& pair, std::int64_t step);

  kit::Manipulator me_;
  Crowd crowd_;
  std::map<objdb::ObjectId, Pair> pairs_;
  Method automatic_ = Method::full;
  double steps_ = 0;         // internal steps a tick
  std::vector<int> fields_;  // of the parameters, in the order of their table
  const objdb::Type* fields_of_ = nullptr;
  // the first neck below each folder, found anew in every tick that asks for it
  std::unordered_map<std::string_view, const objdb::Object*> necks_;
  bool necks_known_ = false;
};

}  // namespace eye
