#pragma once

#include <map>
#include <memory>
#include <string>

#include "manipulators/arm_ik/figure_chain.h"
#include "manipulators/arm_ik/reacher.h"
#include "manipulators/kit/manipulator.h"

namespace arm_ik {

/// The limbs of a world: one object of type `arm` each, moved at every tick through the joints between root and tip.
class Arms {
 public:
  Arms();
  int run() { return me_.run(); }

 private:
  struct Limb {
    std::vector<double> fingerprint;
    std::string fault;  // why there is no chain
    std::vector<objdb::ObjectId> joints;
    std::unique_ptr<Reacher> reacher;
    objdb::ObjectId target = 0;  // in the tick before
    bool known = false;          // has been through a tick, or recalled
    bool lost = false;           // its target was deleted
  };

  objdb::Result<std::string> reach(objdb::Words words);
  void tick(const kit::Tick& tick);
  void weigh(const objdb::Object& segment);
  void move(const objdb::Object& arm, Limb& limb, const kit::Tick& tick);
  bool find(const objdb::Object& arm, Limb& limb);
  void stand(const objdb::Object& arm, std::string_view status, const std::string& reason);
  void report(const objdb::Object& arm, const Limb& limb, const Goal& goal, const Solution& solution,
              std::span<const double> q);
  void report_anatomy(const objdb::Object& arm, const Limb& limb, std::span<const double> q);
  void remember();
  void recall(const objdb::Object& arm, Limb& limb);

  kit::Manipulator me_;
  std::map<objdb::ObjectId, Limb> limbs_;
};

}  // namespace arm_ik
