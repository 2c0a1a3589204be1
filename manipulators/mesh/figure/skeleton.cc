#include "manipulators/mesh/figure/skeleton.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include "manipulators/mesh/figure/arm.h"
#include "manipulators/mesh/figure/solve.h"
#include "manipulators/mesh/figure/uniform.h"

namespace figure {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Translation3d;
using Eigen::Vector3d;

constexpr double degree = M_PI / 180;

Isometry3d at(const Vector3d& p) { return Isometry3d(Translation3d(p)); }

/// A joint with its line and its range, before it becomes a row of a table; degrees.
struct Hinge {
  std::string name;
  Axis axis;
  double lower, upper, stand = 0;
};

/// Appends a chain of hinges below `parent`, whose frame stands at `X_parent` when all angles are 0. Returns the frame
/// of the last joint.
Isometry3d add_chain(Skeleton& skeleton, const std::string& parent, const Isometry3d& X_parent,
                     const std::vector<Hinge>& hinges) {
  std::vector<Axis> axes;
  for (const Hinge& hinge : hinges) {
    axes.push_back(hinge.axis);
  }
  const DhChain chain = denavit_hartenberg(axes, Isometry3d::Identity());
  std::string above = parent;
  Isometry3d X = chain.base;
  for (std::size_t i = 0; i < hinges.size(); ++i) {
    const Hinge& hinge = hinges[i];
    Part joint;
    joint.name = hinge.name;
    joint.parent = above;
    joint.offset = i == 0 ? X_parent.inverse() * chain.base : Isometry3d::Identity();
    joint.is_joint = true;
    joint.dh = chain.rows[i];
    joint.lower = hinge.lower * degree;
    joint.upper = hinge.upper * degree;
    joint.stand = hinge.stand * degree;
    skeleton.parts.push_back(joint);
    above = hinge.name;
    X = X * chain.rows[i].transform(0);
  }
  return X;
}

void add_node(Skeleton& skeleton, const std::string& name, const std::string& parent, const Isometry3d& offset) {
  Part node;
  node.name = name;
  node.parent = parent;
  node.offset = offset;
  skeleton.parts.push_back(node);
}

/// Ranges of the four levels that stand for the joints of the lumbar and thoracic spine, degrees: sums over the discs
/// each level stands for. Lumbar flexion and extension: Pearcy, Portek and Shepherd 1984; everything else: White and
/// Panjabi 1990, flexion taken as two thirds of their combined range. Both from memory.
struct Level {
  const char* name;
  double flexion, extension, lateral, axial;
};
constexpr Level levels[] = {
    {"l5_s1", 22, 7, 9, 3},     // L4-5, L5-S1
    {"l3_l4", 30, 9, 22, 6},    // L1-2, L2-3, L3-4
    {"t12_l1", 20, 10, 24, 8},  // T9-10 to T12-L1
    {"t7_t8", 24, 12, 40, 40},  // T1-2 to T8-9; the rib cage halves the lateral and axial sums below
};

/// The rib cage as a whole stiffens the upper level to about half (White and Panjabi).
constexpr double rib_cage = 0.5;

Isometry3d add_spine(Skeleton& skeleton, const Landmarks& marks, const Isometry3d& X_pelvis) {
  std::vector<Hinge> hinges;
  for (std::size_t i = 0; i < marks.spine.size(); ++i) {
    const Level& level = levels[i];
    const double stiff = i + 1 == marks.spine.size() ? rib_cage : 1;
    const std::string name = level.name;
    const Vector3d& p = marks.spine[i];
    // forward flexion turns up towards forward, about the axis to the left
    hinges.push_back({name + "_flexion", {p, Vector3d::UnitX()}, -stiff * level.extension, stiff * level.flexion});
    hinges.push_back({name + "_lateral", {p, Vector3d::UnitZ()}, -stiff * level.lateral, stiff * level.lateral});
    hinges.push_back({name + "_axial", {p, Vector3d::UnitY()}, -stiff * level.axial, stiff * level.axial});
  }
  return add_chain(skeleton, "pelvis", X_pelvis, hinges);
}

/// Mirrors in x = 0.
Vector3d mirrored(const Vector3d& p) { return {-p.x(), p.y(), p.z()}; }
Matrix3d mirrored(const Matrix3d& R) {
  const Matrix3d M = Vector3d(-1, 1, 1).asDiagonal();
  return M * R * M;
}
Isometry3d mirrored(const Isometry3d& X) {
  Isometry3d result = Isometry3d::Identity();
  result.linear() = mirrored(Matrix3d(X.linear()));
  result.translation() = mirrored(Vector3d(X.translation()));
  return result;
}
/// A frame that is mirrored in the world and in its own z, as the frames of a mirrored Denavit-Hartenberg row are.
Isometry3d mirrored_link(const Isometry3d& X) {
  const Matrix3d flip = Vector3d(1, 1, -1).asDiagonal();
  Isometry3d result = Isometry3d::Identity();
  result.linear() = Vector3d(-1, 1, 1).asDiagonal() * Matrix3d(X.linear()) * flip;
  result.translation() = mirrored(Vector3d(X.translation()));
  return result;
}

/// The right arm as fitted to the body: its shape, its angles at bind time, and the thorax frame's origin.
struct ArmFit {
  Arm arm;
  ArmScale scale;
  std::array<double, Arm::joints> bind;
  Vector3d thorax;  ///< origin of the thorax frame in the actor's frame
  Matrix3d hand;    ///< orientation of the hand (x radial, -y distal, z dorsal) in the wrist's frame
};

/// Half a turn about y between the arm's frame (x right, z back) and the body's (x left, z forward).
Matrix3d body_from_arm() { return Vector3d(-1, 1, -1).asDiagonal(); }

/// Scales, bind angles and thorax so that shoulder, elbow and wrist come to the landmarks and the palm faces its way.
ArmFit fit_arm(const Landmarks& marks) {
  const auto to_arm = [](const Vector3d& left) { return Vector3d(body_from_arm().transpose() * mirrored(left)); };
  const Vector3d shoulder = to_arm(marks.shoulder);
  const Vector3d elbow = to_arm(marks.elbow);
  const Vector3d wrist = to_arm(marks.wrist);
  const Vector3d palm = to_arm(marks.palm);

  ArmFit fit;
  // the girdle stands as the rhythm has it for an arm held so, but for its length and the pull of the collarbone
  // backwards, which follow from the width of the shoulders and their place behind the breastbone
  const Arm model = scaled_arm(1, 1, 1);
  const Vector3d up = (shoulder - elbow).normalized();
  const std::array<double, 6> girdle =
      girdle_rhythm(model, std::atan2(up.z(), -up.x()), std::acos(std::clamp(up.y(), -1.0, 1.0)));
  fit.bind = model.rest;
  std::copy(girdle.begin(), girdle.end(), fit.bind.begin());
  const Vector3d notch = to_arm(marks.sternum - Vector3d(0, 0, 0.008));
  // a frame's origin lies where common normals meet: the joint's centre is that of the frame behind gh_y
  const auto shoulder_from_notch = [&](double scale, double pull) {
    std::array<double, Arm::joints> q = fit.bind;
    q[Arm::sc_y] = pull;
    return Vector3d(scaled_arm(scale, 1, 1).frames(q)[Arm::gh_z].translation());
  };
  const Eigen::VectorXd found = least_squares(
      [&](const Eigen::VectorXd& x) {
        const Vector3d gap = shoulder_from_notch(x[0], x[1]) - (shoulder - notch);
        return Eigen::VectorXd(Eigen::Vector2d(gap.x(), gap.z()));
      },
      Eigen::Vector2d(1, girdle[Arm::sc_y]));
  fit.scale.girdle = found[0];
  fit.bind[Arm::sc_y] = std::clamp(found[1], model.lower[Arm::sc_y], model.upper[Arm::sc_y]);
  const Vector3d thorax = shoulder - shoulder_from_notch(fit.scale.girdle, fit.bind[Arm::sc_y]);
  fit.thorax = body_from_arm() * Vector3d(0, thorax.y(), thorax.z());

  // the origin of the hinge's frame, where its axis passes the humerus, is the elbow's centre
  const auto residual = [&](const Eigen::VectorXd& x) {
    const Arm arm = scaled_arm(fit.scale.girdle, x[5], x[6]);
    std::array<double, Arm::joints> q = fit.bind;
    std::copy(x.data(), x.data() + 5, q.begin() + Arm::gh_y);
    const auto frames = arm.frames(q);
    const Isometry3d& hand = frames[Arm::joints];
    Eigen::VectorXd r(7);
    r.segment<3>(0) = thorax + frames[Arm::el_x].translation() - elbow;
    r.segment<3>(3) = thorax + hand.translation() - wrist;
    // the palm faces against the wrist frame's z; only its turn about the forearm can be fitted
    const Vector3d forearm = (wrist - elbow).normalized();
    const Vector3d wanted = palm - palm.dot(forearm) * forearm;
    r[6] = 0.1 * hand.linear().col(2).cross(-wanted.normalized()).dot(forearm);
    return r;
  };
  Eigen::VectorXd start(7);
  start << 0, 40 * degree, 0, 30 * degree, 80 * degree, 1, 1;
  const Eigen::VectorXd x = least_squares(residual, start);
  std::copy(x.data(), x.data() + 5, fit.bind.begin() + Arm::gh_y);
  fit.scale.humerus = x[5];
  fit.scale.forearm = x[6];
  fit.arm = scaled_arm(fit.scale.girdle, x[5], x[6]);
  const auto frames = fit.arm.frames(fit.bind);

  Matrix3d hand;
  hand.col(1) = (wrist - to_arm(marks.fingertip)).normalized();
  hand.col(2) = (-palm + palm.dot(hand.col(1)) * hand.col(1)).normalized();
  hand.col(0) = hand.col(1).cross(hand.col(2));
  fit.hand = frames[Arm::joints].linear().transpose() * hand;
  return fit;
}

/// Standing at ease, the girdle at rest: the upper arm hangs a little outward, the elbow is a little bent, the palm
/// faces the thigh. Angles of the five joints from gh_y on, inside their limits.
std::array<double, Arm::joints> standing(const ArmFit& fit) {
  std::array<double, Arm::joints> q = fit.arm.rest;
  const Vector3d upper_arm = Vector3d(0.14, -1, 0).normalized();
  const Vector3d forearm = Vector3d(0.06, -1, -0.28).normalized();
  const Vector3d palm = Vector3d(-1, 0, 0.25).normalized();
  const auto with = [&](const Eigen::VectorXd& x) {
    std::array<double, Arm::joints> posture = q;
    std::copy(x.data(), x.data() + x.size(), posture.begin() + Arm::gh_y);
    return posture;
  };
  const auto residual = [&](const Eigen::VectorXd& x) {
    const std::array<double, Arm::joints> posture = with(x);
    const auto frames = fit.arm.frames(posture);
    const Vector3d elbow = frames[Arm::el_x].translation();
    Eigen::VectorXd r(14);
    r.segment<3>(0) = (elbow - frames[Arm::gh_z].translation()).normalized() - upper_arm;
    r.segment<3>(3) = (frames[Arm::joints].translation() - elbow).normalized() - forearm;
    r.segment<3>(6) = 0.3 * (-(frames[Arm::joints].linear() * fit.hand).col(2) - palm);
    // limits as stiff walls
    for (int i = 0; i < 5; ++i) {
      const double angle = x[i];
      const double inside = std::clamp(angle, fit.arm.lower[Arm::gh_y + i] + 0.01, fit.arm.upper[Arm::gh_y + i] - 0.01);
      r[9 + i] = 10 * (angle - inside);
    }
    return r;
  };
  Eigen::VectorXd start(5);
  start << 0.2, 0.2, -0.2, 0.3, 1.3;
  Eigen::VectorXd x = least_squares(residual, start);
  for (int i = 0; i < 5; ++i) {
    x[i] = std::clamp(x[i], fit.arm.lower[Arm::gh_y + i], fit.arm.upper[Arm::gh_y + i]);
  }
  return with(x);
}

struct Side {
  std::string name;
  bool left;
};

void add_arm(Skeleton& skeleton, const Side& side, const ArmFit& fit, const Landmarks& marks) {
  const std::array<double, Arm::joints> stand = standing(fit);
  const auto sided = [&](const Isometry3d& right) { return side.left ? mirrored(right) : right; };
  std::string above = "thorax";
  for (int i = 0; i < Arm::joints; ++i) {
    Part joint;
    joint.name = side.name + "_" + fit.arm.names[i];
    joint.parent = above;
    joint.is_joint = true;
    if (i == 0) {
      Isometry3d base = Isometry3d::Identity();
      base.linear() = body_from_arm() * fit.arm.base.linear();
      base.translation() = body_from_arm() * fit.arm.base.translation();
      joint.offset = side.left ? mirrored_link(base) : base;
    }
    joint.dh = fit.arm.rows[i];
    if (side.left) {
      joint.dh.d = -joint.dh.d;
      joint.dh.alpha = -joint.dh.alpha;
    }
    joint.lower = fit.arm.lower[i];
    joint.upper = fit.arm.upper[i];
    joint.rest = stand[i];
    joint.stand = stand[i];
    joint.bind = fit.bind[i];
    skeleton.parts.push_back(joint);
    above = joint.name;
  }

  // the hand's own frame is the body's when the arm hangs with the palm forward: x left, y up, z forward
  Isometry3d wrist = fit.arm.tool;
  wrist.linear() = wrist.linear() * fit.hand * body_from_arm().transpose();
  const Isometry3d turn = [&] {
    Isometry3d X = wrist;
    if (side.left) {
      X.linear() = Vector3d(1, 1, -1).asDiagonal() * wrist.linear() * Vector3d(-1, 1, 1).asDiagonal();
      X.translation() = Vector3d(1, 1, -1).asDiagonal() * wrist.translation();
    }
    return X;
  }();
  add_node(skeleton, side.name + "_wrist", above, turn);
  // end effectors: where a ball is held in the palm, and the tip of the middle finger
  const double length = (marks.fingertip - marks.wrist).norm();
  const double grip = 0.026 * marks.stature;
  add_node(skeleton, side.name + "_hand", side.name + "_wrist", sided(at({0, -0.52 * length, grip})));
  add_node(skeleton, side.name + "_fingertip", side.name + "_wrist", sided(at({0, -length, 0})));
}

/// Ranges of the leg, degrees: Merck Manual, normal values for range of motion of joints (hip flexion 125, extension
/// 15, abduction 45, rotation 45; knee 130; ankle 50 down, 20 up; foot 35 in, 25 out; toes 30 down, 80 up), except
/// adduction: 30 (AAOS), and 5 of knee extension.
void add_leg(Skeleton& skeleton, const Side& side, const Landmarks& marks, const Isometry3d& X_pelvis) {
  const double outward = side.left ? 1 : -1;
  const auto sided = [&](const Vector3d& left) { return side.left ? left : mirrored(left); };
  // at angle 0 the leg is straight down from the hip and the foot points forward
  const Vector3d hip = sided(marks.hip);
  const Vector3d knee = hip - Vector3d(0, (marks.hip - marks.knee).norm(), 0);
  const Vector3d ankle = knee - Vector3d(0, (marks.knee - marks.ankle).norm(), 0);
  const Vector3d ball = ankle + Vector3d(0, marks.ball.y() - marks.ankle.y(), marks.ball.z() - marks.ankle.z());
  const Vector3d toe = ball + Vector3d(0, marks.toe.y() - marks.ball.y(), marks.toe.z() - marks.ball.z());
  // the subtalar axis rises 42 degrees forward and points 23 degrees to the middle (Inman 1976, from memory), 12 mm
  // below the ankle's axis; positive turns the sole inward
  const Vector3d subtalar = Vector3d(-outward * std::cos(42 * degree) * std::sin(23 * degree), std::sin(42 * degree),
                                     std::cos(42 * degree) * std::cos(23 * degree))
                                .normalized();
  const Vector3d x = Vector3d::UnitX();
  const auto name = [&](const char* joint) { return side.name + "_" + joint; };
  const Isometry3d X = add_chain(skeleton, "pelvis", X_pelvis,
                                 {{name("hip_flexion"), {hip, -x}, -15, 125},
                                  {name("hip_abduction"), {hip, outward * Vector3d::UnitZ()}, -30, 45},
                                  {name("hip_rotation"), {hip, -outward * Vector3d::UnitY()}, -45, 45},
                                  {name("knee_flexion"), {knee, x}, -5, 130},
                                  {name("ankle_flexion"), {ankle, -x}, -50, 20},
                                  {name("subtalar"), {ankle - Vector3d(0, 0.012, 0), -outward * subtalar}, -25, 35},
                                  {name("toe_flexion"), {ball, x}, -80, 30}});

  // the foot hangs on the subtalar joint, before the toe's row moves the frame
  const Isometry3d before_toe = X * skeleton.parts.back().dh.transform(0).inverse();
  add_node(skeleton, name("foot"), name("subtalar"), before_toe.inverse() * at(ball));
  add_node(skeleton, name("toes"), name("toe_flexion"), X.inverse() * at(toe));
}

/// The frame in which a joint turns; the frame named after a joint stands behind its row of the table.
Isometry3d before(const std::map<std::string, Isometry3d>& X, const Skeleton& skeleton, const std::string& name) {
  const auto found =
      std::find_if(skeleton.parts.begin(), skeleton.parts.end(), [&](const Part& part) { return part.name == name; });
  return X.at(found->parent) * found->offset;
}

Part& part(Skeleton& skeleton, const std::string& name) {
  return *std::find_if(skeleton.parts.begin(), skeleton.parts.end(), [&](const Part& p) { return p.name == name; });
}

/// Bind and standing angles of a leg: knee and ankle at their landmarks, the foot flat and pointing forward.
void fit_leg(Skeleton& skeleton, const Side& side, const Landmarks& marks) {
  const std::array<std::string, 6> joints = {"hip_flexion",  "hip_abduction", "hip_rotation",
                                             "knee_flexion", "ankle_flexion", "subtalar"};
  const auto sided = [&](const Vector3d& left) { return side.left ? left : mirrored(left); };
  const auto posture = [&](const Vector3d& knee, const Vector3d& ankle) {
    const auto residual = [&](const Eigen::VectorXd& q) {
      const auto X = frames(skeleton, [&](const Part& p) {
        for (std::size_t i = 0; i < joints.size(); ++i) {
          if (p.name == side.name + "_" + joints[i]) {
            return q[i];
          }
        }
        return 0.0;
      });
      Eigen::VectorXd r(9);
      r.segment<3>(0) = before(X, skeleton, side.name + "_knee_flexion").translation() - knee;
      r.segment<3>(3) = X.at(side.name + "_foot").translation() -
                        (ankle + Vector3d(0, marks.ball.y() - marks.ankle.y(), marks.ball.z() - marks.ankle.z()));
      // a level sole weighs as much as 10 cm: the frame of the foot node is the world's
      r.segment<3>(6) = 0.1 * (X.at(side.name + "_foot").linear().col(1) - Vector3d::UnitY());
      return r;
    };
    return least_squares(residual, Eigen::VectorXd::Constant(6, 0.05));
  };
  const Eigen::VectorXd bind = posture(sided(marks.knee), sided(marks.ankle));
  for (std::size_t i = 0; i < joints.size(); ++i) {
    part(skeleton, side.name + "_" + joints[i]).bind = bind[i];
  }
}

/// Collects segments given by points in the body's frame at bind time.
struct SegmentMaker {
  Skeleton& skeleton;
  const std::map<std::string, Isometry3d>& X;

  void add(const std::string& name, const std::string& parent, const Vector3d& from, const Vector3d& to, double radius,
           const std::string& twist_from = "", double twist = 1) {
    const Isometry3d& bind = X.at(parent);
    skeleton.segments.push_back(
        {name, parent, bind.inverse() * from, bind.inverse() * to, radius, twist_from, twist, bind});
  }
};

void add_segments(Skeleton& skeleton, const Landmarks& marks) {
  const auto X = frames(skeleton, [](const Part& p) { return p.bind; });
  SegmentMaker make{skeleton, X};
  const double H = marks.stature / 1.66;
  const auto& spine = marks.spine;
  const Vector3d middle(0, marks.hip.y(), marks.hip.z());

  make.add("pelvis", "pelvis", middle, spine[0], 0.13 * H);
  make.add("lumbar_lower", "l5_s1_axial", spine[0], spine[1], 0.12 * H);
  make.add("lumbar_upper", "l3_l4_axial", spine[1], spine[2], 0.12 * H);
  make.add("thorax_lower", "t12_l1_axial", spine[2], spine[3], 0.13 * H);
  make.add("thorax_upper", "thorax", spine[3], X.at("neck_c7_t1_axial").translation(), 0.12 * H);

  // one segment a level of the neck, from its centre to the next one
  const char* necks[] = {"c7_t1", "c6_7", "c5_6", "c4_5", "c3_4", "c2_3", "c1_2"};
  for (std::size_t i = 0; i < std::size(necks); ++i) {
    const std::string joint = std::string("neck_") + necks[i];
    const Vector3d low = before(X, skeleton, joint + "_flexion").translation();
    make.add(joint, joint + "_axial", low, X.at(joint + "_axial").translation(), 0.055 * H);
  }
  const Vector3d skull = X.at("head").translation();
  make.add("head", "head", skull + Vector3d(0, 0.03, 0.01) * H, skull + Vector3d(0, 0.08, 0.01) * H, 0.085 * H);
  // the inside of the mouth stands between a single axis and most of the skin around it, which would then follow the
  // chest; so the flesh on every side of the mouth has an axis of its own, and all go with the skull
  const auto flesh = [&](const char* name, const Vector3d& from, const Vector3d& to) {
    make.add(name, "head", skull + from * H, skull + to * H, 0.05 * H);
  };
  flesh("jaw", {0, -0.06, 0.05}, {0, -0.065, 0.095});
  flesh("right_jaw", {-0.045, -0.045, 0.03}, {-0.012, -0.06, 0.10});
  flesh("left_jaw", {0.045, -0.045, 0.03}, {0.012, -0.06, 0.10});
  flesh("front_jaw", {-0.012, -0.05, 0.105}, {0.012, -0.05, 0.105});
  flesh("right_upper_jaw", {-0.045, -0.022, 0.06}, {-0.01, -0.024, 0.115});
  flesh("left_upper_jaw", {0.045, -0.022, 0.06}, {0.01, -0.024, 0.115});
  flesh("front_upper_jaw", {-0.012, -0.02, 0.113}, {0.012, -0.02, 0.113});

  for (const Side& side : {Side{"right", false}, Side{"left", true}}) {
    const auto name = [&](const char* part) { return side.name + "_" + part; };
    const double out = side.left ? 1 : -1;
    const Vector3d gh = X.at(name("gh_y")).translation();
    const Vector3d sc = before(X, skeleton, name("sc_y")).translation();
    const Vector3d ac = X.at(name("sc_x")).translation();
    const auto sided = [&](const Vector3d& left) { return side.left ? left : mirrored(left); };
    const Vector3d elbow = sided(marks.elbow);
    const Vector3d wrist = sided(marks.wrist);
    const auto between = [](const Vector3d& a, const Vector3d& b, double share) {
      return Vector3d(a + share * (b - a));
    };

    make.add(name("clavicle"), name("sc_x"), between(sc, gh, 0.3), between(ac, gh, 0.4), 0.045 * H);
    make.add(name("scapula"), name("ac_x"), gh + Vector3d(-0.01 * out, 0.01, -0.01) * H,
             gh + Vector3d(-0.06 * out, -0.06, -0.045) * H, 0.05 * H);
    // turns of the upper arm run out towards the shoulder, turns of the hand towards the elbow
    make.add(name("humerus_1"), name("gh_yy"), gh, between(gh, elbow, 0.4), 0.05 * H, name("scapula"), 0.35);
    make.add(name("humerus_2"), name("gh_yy"), between(gh, elbow, 0.4), between(gh, elbow, 0.7), 0.045 * H,
             name("scapula"), 0.7);
    make.add(name("humerus_3"), name("gh_yy"), between(gh, elbow, 0.7), elbow, 0.045 * H);
    make.add(name("ulna"), name("el_x"), elbow, between(elbow, wrist, 0.22), 0.042 * H);
    make.add(name("forearm_1"), name("ps_y"), between(elbow, wrist, 0.22), between(elbow, wrist, 0.5), 0.04 * H,
             name("ulna"), 0.3);
    make.add(name("forearm_2"), name("ps_y"), between(elbow, wrist, 0.5), between(elbow, wrist, 0.78), 0.035 * H,
             name("ulna"), 0.65);
    make.add(name("forearm_3"), name("ps_y"), between(elbow, wrist, 0.78), wrist, 0.03 * H, name("ulna"), 0.93);
    make.add(name("hand"), name("ps_y"), wrist, sided(marks.fingertip), 0.035 * H);

    const Vector3d hip = sided(marks.hip);
    const Vector3d knee = sided(marks.knee);
    const Vector3d ankle = sided(marks.ankle);
    make.add(name("thigh_1"), name("hip_rotation"), hip, between(hip, knee, 0.4), 0.085 * H, "pelvis", 0.35);
    make.add(name("thigh_2"), name("hip_rotation"), between(hip, knee, 0.4), knee, 0.07 * H);
    make.add(name("shin"), name("knee_flexion"), knee, ankle, 0.05 * H);
    make.add(name("foot"), name("subtalar"), ankle, sided(marks.ball), 0.04 * H);
    make.add(name("heel"), name("subtalar"), ankle, between(ankle, sided(marks.heel), 0.6), 0.04 * H);
    const Vector3d toe = sided(marks.toe);
    const Vector3d ball = sided(marks.ball);
    make.add(name("big_toe"), name("toe_flexion"), Vector3d(toe.x(), toe.y(), ball.z()), toe - Vector3d(0, 0, 0.01) * H,
             0.025 * H);
    make.add(name("toes"), name("toe_flexion"), ball + Vector3d(0.012 * out, -0.006, 0) * H,
             ball + Vector3d(0.014 * out, -0.009, 0.045) * H, 0.03 * H);
  }
}

/// The pelvis stands as high as the legs at ease are long, and the soles of the shoes thick.
void stand_on_ground(Skeleton& skeleton, const Landmarks& marks) {
  for (Part& p : skeleton.parts) {
    const bool leg = p.name.find("hip_") != std::string::npos || p.name.find("knee_") != std::string::npos ||
                     p.name.find("ankle_") != std::string::npos || p.name.find("subtalar") != std::string::npos;
    if (leg) {
      // half as wide as in the file: spreading angles shrink, the bend of the knee stays
      const bool spread = p.name.find("abduction") != std::string::npos || p.name.find("subtalar") != std::string::npos;
      p.stand = p.bind * (spread ? 0.45 : 1);
      p.rest = p.stand;
    }
  }
  const auto X = frames(skeleton, [](const Part& p) { return p.stand; });
  part(skeleton, "pelvis").offset.translation().y() +=
      marks.ball.y() + sole(marks) - X.at("right_foot").translation().y();
}

double distance(const Vector3d& p, const Vector3d& q) { return (p - q).norm(); }

double fit_error(const Skeleton& skeleton, const Landmarks& marks) {
  const auto X = frames(skeleton, [](const Part& p) { return p.bind; });
  return std::max({distance(X.at("right_gh_yy").translation(), mirrored(marks.elbow)),
                   distance(X.at("left_wrist").translation(), marks.wrist),
                   distance(X.at("right_wrist").translation(), mirrored(marks.wrist)),
                   distance(before(X, skeleton, "left_knee_flexion").translation(), marks.knee),
                   distance(before(X, skeleton, "left_ankle_flexion").translation(), marks.ankle)});
}

}  // namespace

std::map<std::string, Isometry3d> frames(const Skeleton& skeleton, const std::function<double(const Part&)>& angle) {
  std::map<std::string, Isometry3d> X;
  for (const Part& part : skeleton.parts) {
    const Isometry3d above = part.parent.empty() ? Isometry3d::Identity() : X.at(part.parent);
    X[part.name] = above * part.offset;
    if (part.is_joint) {
      X[part.name] = X[part.name] * part.dh.transform(angle(part));
    }
  }
  return X;
}

NeckPlace neck_place(const Landmarks& marks, const Vector3d& rise) {
  NeckPlace place;
  const double height = (marks.skull - marks.neck_base).norm();
  place.scale = height / rise.norm();
  place.position = marks.skull - place.scale * rise - fit_arm(marks).thorax;
  return place;
}

mesh::Result<std::vector<Part>> read_parts(const std::string& script) {
  std::vector<Part> parts;
  std::istringstream lines(script);
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    std::istringstream words(line.substr(0, line.find('#')));
    std::string verb, type, field;
    if (!(words >> verb)) {
      continue;
    }
    Part part;
    words >> type >> part.name;
    part.is_joint = type == "joint";
    bool good = verb == "create" && (type == "joint" || type == "node") && !part.name.empty();
    while (good && words >> field) {
      Vector3d p;
      Eigen::Quaterniond q;
      if (field == "parent") {
        good = static_cast<bool>(words >> part.parent);
      } else if (field == "position") {
        good = static_cast<bool>(words >> p.x() >> p.y() >> p.z());
        part.offset.translation() = p;
      } else if (field == "orientation") {
        good = static_cast<bool>(words >> q.w() >> q.x() >> q.y() >> q.z()) && q.norm() > 0;
        part.offset.linear() = q.normalized().toRotationMatrix();
      } else if (field == "dh") {
        good = static_cast<bool>(words >> part.dh.theta0 >> part.dh.d >> part.dh.a >> part.dh.alpha);
      } else if (field == "lower") {
        good = static_cast<bool>(words >> part.lower);
      } else if (field == "upper") {
        good = static_cast<bool>(words >> part.upper);
      } else if (field == "rest" || field == "angle") {
        good = static_cast<bool>(words >> (field == "rest" ? part.rest : part.stand));
      } else {
        good = false;
      }
    }
    if (!good) {
      return mesh::Error{"syntax", "line " + std::to_string(number) + " of the neck: expected create joint or node " +
                                       "with parent, position, orientation, dh, lower, upper, rest or angle; is " +
                                       line};
    }
    part.bind = part.rest;
    parts.push_back(part);
  }
  return parts;
}

Skeleton make_skeleton(const Landmarks& marks, const std::vector<Part>& neck) {
  Skeleton skeleton;
  const Isometry3d X_pelvis = at({0, marks.hip.y(), marks.hip.z()});
  add_node(skeleton, "pelvis", "", X_pelvis);
  const Isometry3d X_spine = add_spine(skeleton, marks, X_pelvis);
  const ArmFit fit = fit_arm(marks);
  skeleton.arm_scale = fit.scale;
  add_node(skeleton, "thorax", skeleton.parts.back().name, X_spine.inverse() * at(fit.thorax));
  skeleton.parts.insert(skeleton.parts.end(), neck.begin(), neck.end());
  add_node(skeleton, "right_eye_socket", "head", at(mirrored(marks.eye) - marks.skull));
  add_node(skeleton, "left_eye_socket", "head", at(marks.eye - marks.skull));

  for (const Side& side : {Side{"right", false}, Side{"left", true}}) {
    add_arm(skeleton, side, fit, marks);
    add_leg(skeleton, side, marks, X_pelvis);
    fit_leg(skeleton, side, marks);
  }
  skeleton.fit_error = fit_error(skeleton, marks);
  add_segments(skeleton, marks);
  stand_on_ground(skeleton, marks);
  std::sort(skeleton.segments.begin(), skeleton.segments.end(),
            [](const Segment& a, const Segment& b) { return a.name < b.name; });
  return skeleton;
}

std::vector<mesh::Bone> bones(const Skeleton& skeleton) {
  std::map<std::string, int> number;
  for (const Segment& segment : skeleton.segments) {
    number.emplace(segment.name, static_cast<int>(number.size()));
  }
  std::vector<mesh::Bone> result;
  for (const Segment& segment : skeleton.segments) {
    mesh::Bone bone;
    bone.name = segment.name;
    bone.bind = segment.bind;
    bone.from = segment.from;
    bone.to = segment.to;
    bone.radius = segment.radius;
    bone.twist_from = segment.twist_from.empty() ? -1 : number.at(segment.twist_from);
    bone.twist = segment.twist;
    result.push_back(bone);
  }
  return result;
}

std::vector<Isometry3d> bone_pose(const Skeleton& skeleton, const std::function<double(const Part&)>& angle) {
  const auto X = frames(skeleton, angle);
  std::vector<Isometry3d> pose;
  for (const Segment& segment : skeleton.segments) {
    pose.push_back(X.at(segment.parent));
  }
  return pose;
}

}  // namespace figure
