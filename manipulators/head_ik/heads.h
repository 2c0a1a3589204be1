#pragma once

#include <map>
#include <optional>
#include <string>

#include "manipulators/head_ik/chain.h"
#include "manipulators/head_ik/control.h"
#include "manipulators/kit/manipulator.h"

namespace head {

/// The heads of a world: one `neck` object each, moved at every tick through the joints between its root and its tip.
class Heads {
 public:
  Heads();
  int run() { return me_.run(); }

 private:
  // what is remembered of one neck
  struct Head {
    std::vector<double> fingerprint;
    std::optional<Chain> chain;
    std::string fault;  // why there is no chain
    Control control;
    bool known = false;      // has been through a tick
    bool commanded = false;  // by look, since the last tick
    bool gone = false;       // what it looked at was deleted
    // what it looked at in the last tick
    bool active = false;
    objdb::ObjectId target = 0;
    Eigen::Vector3d point{0, 0, 0};
  };

  objdb::Result<std::string> look(objdb::Words words);
  const objdb::Object* neck_of(const objdb::Object& figure) const;
  void tick(const kit::Tick& tick);
  void move(const objdb::Object& object, Head& head, const kit::Tick& tick);
  bool find(const objdb::Object& object, Head& head);
  Settings settings(const objdb::Object& object, const Head& head) const;
  Sight sight(const objdb::Object& object, const Head& head);
  bool retargeted(const objdb::Object& object, Head& head);
  void start_from_joints(Head& head, const kit::Tick& tick);
  void report(const objdb::Object& object, const Head& head, const Control::Report& report);
  void remember();
  void recall(const objdb::Object& object, Head& head);
  std::string reason(const Head& head, const Control::Report& report) const;

  kit::Manipulator me_;
  std::map<objdb::ObjectId, Head> heads_;
};

}  // namespace head
