#include "manipulators/mesh/figure/landmarks.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "manipulators/mesh/figure/section.h"
#include "manipulators/mesh/topology.h"
#include "manipulators/mesh/tree.h"

namespace figure {
namespace {

using Eigen::Vector3d;
using mesh::Surface;

/// Heights as fractions of stature. Hip, knee, ankle, shoulder: Drillis and Contini 1966 (in Winter 1990, figure 4.1).
/// Cervicale, tragion and suprasternale: ANSUR 1988 means, men and women alike (from memory); the disc C7-T1 lies a
/// finger's breadth below the tip of the spinous process, the condyles of the skull one below the tragion.
constexpr double hip_height = 0.530;
constexpr double knee_height = 0.285;
constexpr double ankle_height = 0.039;
constexpr double shoulder_height = 0.818;
constexpr double half_shoulder_width = 0.129;
constexpr double cervical_disc_height = 0.865 - 0.010;
constexpr double condyle_height = 0.925 - 0.007;
constexpr double suprasternal_height = 0.814;
/// Discs as fractions of the way from L5-S1 to C7-T1, by the heights of the vertebrae (Gray's Anatomy: lumbar column
/// 18 cm, thoracic 28 cm, of which five lower thoracic vertebrae about 13; from memory), and the height of L5-S1.
constexpr double sacral_disc_height = 0.575;
constexpr double spine_shares[] = {0.0, 0.155, 0.39, 0.67};
/// The middle of the vertebral column lies about a third of the trunk's depth in front of the skin of the back.
constexpr double spine_depth = 0.33;
/// Ball of the foot from the heel, as a fraction of foot length: instep length 0.72 (ANSUR, from memory).
constexpr double ball_of_foot = 0.72;

/// A straight line with the direction in which it was walked.
struct Line {
  Vector3d point, direction;

  double distance(const Vector3d& p) const { return (p - point).cross(direction).norm(); }
};

/// Least-squares line through points [begin, end), directed from the first to the last.
Line fit(const std::vector<Vector3d>& points, std::size_t begin, std::size_t end) {
  Vector3d mean = Vector3d::Zero();
  for (std::size_t i = begin; i < end; ++i) {
    mean += points[i] / static_cast<double>(end - begin);
  }
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (std::size_t i = begin; i < end; ++i) {
    spread += (points[i] - mean) * (points[i] - mean).transpose();
  }
  Vector3d direction = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors().col(2);
  if (direction.dot(points[end - 1] - points[begin]) < 0) {
    direction = -direction;
  }
  return {mean, direction};
}

/// The point half way between two lines where they come nearest.
Vector3d nearest_point(const Line& g, const Line& h) {
  const double c = g.direction.dot(h.direction);
  const Vector3d w = h.point - g.point;
  const double s = (w.dot(g.direction) - c * w.dot(h.direction)) / (1 - c * c);
  const double t = (c * w.dot(g.direction) - w.dot(h.direction)) / (1 - c * c);
  return 0.5 * (g.point + s * g.direction + h.point + t * h.direction);
}

/// Loops of the left half in a horizontal plane.
std::vector<Loop> left_loops(const Surface& skin, double height) {
  std::vector<Loop> loops = section(skin, {0, height, 0}, Vector3d::UnitY());
  std::erase_if(loops, [](const Loop& loop) { return loop.centroid.x() < 0.01; });
  return loops;
}

/// The loop around the middle plane at a height: trunk, neck or head.
Loop middle_loop(const Surface& skin, double height) {
  std::vector<Loop> loops = section(skin, {0, height, 0}, Vector3d::UnitY());
  std::erase_if(loops, [](const Loop& loop) { return std::abs(loop.centroid.x()) > 0.01; });
  return loops.empty() ? Loop{} : loops.front();
}

/// Hindmost and foremost z of a loop near the middle plane.
std::pair<double, double> depth(const Loop& loop) {
  double back = std::numeric_limits<double>::infinity();
  double front = -back;
  for (const Vector3d& p : loop.points) {
    if (std::abs(p.x()) < 0.02) {
      back = std::min(back, p.z());
      front = std::max(front, p.z());
    }
  }
  return {back, front};
}

Vector3d vertex(const Surface& surface, Eigen::Index v) { return surface.V.row(v).transpose().cast<double>(); }

/// Sections of the left arm from the hand to the armpit, in planes across the line from fingertip to shoulder.
/// The centroid of an oblique section of a cylinder lies on its axis, so one direction serves the bent arm.
struct Arm {
  std::vector<Loop> loops;
  Vector3d tip;
};

Arm arm_sections(const Surface& skin, double stature) {
  Eigen::Index tip = 0;
  skin.V.col(0).maxCoeff(&tip);
  Arm arm;
  arm.tip = vertex(skin, tip);
  const Vector3d shoulder(half_shoulder_width * stature, shoulder_height * stature, 0);
  const Vector3d along = (shoulder - arm.tip).normalized();
  constexpr double step = 0.005;
  const double length = (shoulder - arm.tip).norm();
  for (double s = step; s < length; s += step) {
    const std::vector<Loop> loops = section(skin, arm.tip + s * along, along);
    const Vector3d expected = arm.loops.empty() ? Vector3d(arm.tip + s * along) : arm.loops.back().centroid;
    const auto nearer = [&](const Loop& a, const Loop& b) {
      return (a.centroid - expected).norm() < (b.centroid - expected).norm();
    };
    const auto nearest = std::min_element(loops.begin(), loops.end(), nearer);
    if (nearest == loops.end()) {
      continue;
    }
    // the arm ends where its section opens into the trunk's
    if (s > 0.25 * length && !arm.loops.empty() && nearest->area > 1.5 * arm.loops.back().area) {
      break;
    }
    arm.loops.push_back(*nearest);
  }
  return arm;
}

/// Elbow and the lines of forearm and upper arm: the break that makes two straight lines fit the centroids best.
struct Bend {
  Line forearm, upper_arm;
};

Bend elbow_bend(const std::vector<Vector3d>& axis) {
  Bend best;
  double least = std::numeric_limits<double>::infinity();
  const std::size_t margin = axis.size() / 4;
  for (std::size_t split = margin; split + margin < axis.size(); ++split) {
    const Bend bend{fit(axis, 0, split), fit(axis, split, axis.size())};
    double sum = 0;
    for (std::size_t i = 0; i < axis.size(); ++i) {
      const double distance = i < split ? bend.forearm.distance(axis[i]) : bend.upper_arm.distance(axis[i]);
      sum += distance * distance;
    }
    if (sum < least) {
      least = sum;
      best = bend;
    }
  }
  return best;
}

/// Centre of the ball that ends the upper arm. On its axis below the shoulder the skin straight above is farther than
/// the arm's radius (the arm hangs obliquely); at the centre of the ball it is just the radius.
Vector3d shoulder_centre(const Surface& skin, const Line& upper_arm, const Vector3d& armpit) {
  const mesh::Tree tree(skin.V, skin.F);
  constexpr double reach = 0.5;
  const auto clearance = [&](const Vector3d& p, const Vector3d& way) {
    return reach * tree.first_hit(p, p + reach * way).share;
  };
  const Vector3d& along = upper_arm.direction;
  const Vector3d across = (Vector3d::UnitY() - along.y() * along).normalized();
  const Vector3d start = upper_arm.point + (armpit - upper_arm.point).dot(along) * along;
  const double radius = clearance(start, across);
  Vector3d p = start;
  while (clearance(p, Vector3d::UnitY()) > radius && (p - start).norm() < 0.2) {
    p += 0.001 * along;
  }
  return p;
}

/// Palm: fingers and hand beyond the wrist are flat; the thumb, out of line on one side, tells the palm from the back.
void find_hand(const Surface& skin, Landmarks& marks, const Vector3d& forearm) {
  std::vector<Vector3d> hand;
  for (Eigen::Index v = 0; v < skin.V.rows(); ++v) {
    const Vector3d p = vertex(skin, v);
    if (p.x() > 0.05 && (p - marks.wrist).dot(forearm) > 0 && (p - marks.wrist).norm() < 0.16 * marks.stature) {
      hand.push_back(p);
    }
  }
  // the middle finger ends farthest from the wrist
  marks.fingertip = *std::max_element(hand.begin(), hand.end(), [&](const Vector3d& a, const Vector3d& b) {
    return (a - marks.wrist).norm() < (b - marks.wrist).norm();
  });
  const Vector3d along = (marks.fingertip - marks.wrist).normalized();
  const double length = (marks.fingertip - marks.wrist).norm();
  marks.knuckle = marks.wrist + 0.5 * length * along;

  // the four fingers and the palm in front of the thumb's root lie in one plane
  std::vector<Vector3d> flat;
  std::vector<Vector3d> near_wrist;
  for (const Vector3d& p : hand) {
    const double share = (p - marks.wrist).dot(along) / length;
    (share > 0.62 ? flat : near_wrist).push_back(p);
  }
  Vector3d mean = Vector3d::Zero();
  for (const Vector3d& p : flat) {
    mean += p / static_cast<double>(flat.size());
  }
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Vector3d& p : flat) {
    spread += (p - mean) * (p - mean).transpose();
  }
  Vector3d normal = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors().col(0);
  normal = (normal - normal.dot(along) * along).normalized();
  // thumb: the point near the wrist farthest from the hand's axis, on the left hand on the side normal x along
  const Vector3d thumb = *std::max_element(near_wrist.begin(), near_wrist.end(), [&](const auto& a, const auto& b) {
    return (a - marks.wrist).cross(along).norm() < (b - marks.wrist).cross(along).norm();
  });
  if (normal.cross(along).dot(thumb - marks.wrist) < 0) {
    normal = -normal;
  }
  marks.palm = normal;
}

bool find_arm(const Surface& skin, Landmarks& marks) {
  const Arm arm = arm_sections(skin, marks.stature);
  if (arm.loops.size() < 40) {
    return false;
  }
  // wrist: the narrowest section before the forearm; the fingers, apart, are narrower still and are left out
  const std::size_t hand_end = arm.loops.size() / 4;
  const auto narrower = [](const Loop& a, const Loop& b) { return a.perimeter < b.perimeter; };
  const auto wrist = std::min_element(arm.loops.begin() + hand_end, arm.loops.begin() + arm.loops.size() / 2, narrower);
  std::vector<Vector3d> axis;
  for (auto loop = wrist; loop != arm.loops.end(); ++loop) {
    axis.push_back(loop->centroid);
  }
  const Bend bend = elbow_bend(axis);
  marks.wrist = wrist->centroid;
  marks.elbow = nearest_point(bend.forearm, bend.upper_arm);
  marks.shoulder = shoulder_centre(skin, bend.upper_arm, arm.loops.back().centroid);
  find_hand(skin, marks, (marks.wrist - marks.elbow).normalized());
  return true;
}

bool find_leg(const Surface& skin, Landmarks& marks) {
  // the thigh, from above the knee up to where the legs meet
  std::vector<Vector3d> thigh;
  for (double height = 0.36; height < 0.46; height += 0.005) {
    const std::vector<Loop> loops = left_loops(skin, height * marks.stature);
    if (!loops.empty()) {
      thigh.push_back(loops.front().centroid);
    }
  }
  const std::vector<Loop> knee = left_loops(skin, knee_height * marks.stature);
  if (thigh.size() < 10 || knee.empty()) {
    return false;
  }
  const Line line = fit(thigh, 0, thigh.size());
  marks.hip = line.point + (hip_height * marks.stature - line.point.y()) / line.direction.y() * line.direction;
  // the muscles in front pull the thigh's axis forward: the joint lies in the middle of the trunk's depth
  marks.hip.z() = middle_loop(skin, marks.hip.y()).centroid.z();
  marks.knee = knee.front().centroid;

  // the thinnest section above the foot gives the ankle's place in the plane
  Loop ankle;
  ankle.perimeter = std::numeric_limits<double>::infinity();
  for (double height = 0.05; height < 0.12; height += 0.0025) {
    const std::vector<Loop> loops = left_loops(skin, height * marks.stature);
    if (!loops.empty() && loops.front().perimeter < ankle.perimeter) {
      ankle = loops.front();
    }
  }
  marks.ankle = {ankle.centroid.x(), ankle_height * marks.stature, ankle.centroid.z()};

  marks.heel = marks.toe = marks.ankle;
  for (Eigen::Index v = 0; v < skin.V.rows(); ++v) {
    const Vector3d p = vertex(skin, v);
    if (p.x() > 0 && p.y() < marks.ankle.y()) {
      marks.heel = p.z() < marks.heel.z() ? p : marks.heel;
      marks.toe = p.z() > marks.toe.z() ? p : marks.toe;
    }
  }
  marks.ball = marks.heel + ball_of_foot * (marks.toe - marks.heel);
  marks.ball.x() = marks.ankle.x();
  marks.ball.y() = 0.013 * marks.stature;
  return true;
}

bool find_trunk(const Surface& skin, Landmarks& marks) {
  const auto column = [&](double height) {
    const Loop loop = middle_loop(skin, height);
    const auto [back, front] = depth(loop);
    return Vector3d(0, height, back + spine_depth * (front - back));
  };
  const double low = sacral_disc_height * marks.stature;
  const double high = cervical_disc_height * marks.stature;
  for (double share : spine_shares) {
    marks.spine.push_back(column(low + share * (high - low)));
  }
  marks.neck_base = column(high);

  const double notch = suprasternal_height * marks.stature;
  marks.sternum = {0, notch, depth(middle_loop(skin, notch)).second};

  // the skull balances above the middle of the neck, under the ears: the widest points of the head
  Vector3d ear = Vector3d::Zero();
  for (Eigen::Index v = 0; v < skin.V.rows(); ++v) {
    const Vector3d p = vertex(skin, v);
    if (p.y() > 0.88 * marks.stature && p.x() > ear.x()) {
      ear = p;
    }
  }
  marks.skull = {0, condyle_height * marks.stature, ear.z()};
  return ear.x() > 0 && marks.spine.front().allFinite() && marks.neck_base.allFinite();
}

/// Centre and radius of the left eyeball: the sphere through the vertices of its parts, least squares.
bool find_eye(const Surface& body, Landmarks& marks) {
  std::vector<Vector3d> points;
  for (Eigen::Index f = 0; f < body.F.rows(); ++f) {
    if (body.part_names[body.part[f]].find("eye") == std::string::npos) {
      continue;
    }
    for (int corner = 0; corner < 3; ++corner) {
      const Vector3d p = vertex(body, body.F(f, corner));
      if (p.x() > 0) {
        points.push_back(p);
      }
    }
  }
  if (points.size() < 4) {
    return false;
  }
  // |p|^2 = 2 c.p + (r^2 - |c|^2) is linear in c and the bracket
  Eigen::Matrix4d A = Eigen::Matrix4d::Zero();
  Eigen::Vector4d b = Eigen::Vector4d::Zero();
  for (const Vector3d& p : points) {
    const Eigen::Vector4d row(2 * p.x(), 2 * p.y(), 2 * p.z(), 1);
    A += row * row.transpose();
    b += row * p.squaredNorm();
  }
  const Eigen::Vector4d solution = A.ldlt().solve(b);
  marks.eye = solution.head<3>();
  marks.eye_radius = std::sqrt(solution[3] + marks.eye.squaredNorm());
  return true;
}

mesh::Error missing(const std::string& what) {
  return {"range", "the body's " + what +
                       " cannot be found; a closed body standing on y = 0, facing +Z, arms away "
                       "from the trunk, with parts named *eye* for the eyeballs is expected"};
}

}  // namespace

mesh::Result<Landmarks> find_landmarks(const Surface& body) {
  std::vector<bool> is_skin;
  for (int part : body.part) {
    is_skin.push_back(body.part_names[part].find("eye") == std::string::npos);
  }
  const Surface skin = mesh::subset(body, is_skin);
  if (skin.V.rows() == 0 || !mesh::topology(skin).closed()) {
    return missing("closed skin");
  }

  Landmarks marks{};
  marks.stature = mesh::bounds(skin).upper.y();
  if (!(marks.stature > 0.5 && marks.stature < 3)) {
    return missing("stature between 0.5 and 3 m");
  }
  if (!find_eye(body, marks)) {
    return missing("left eyeball");
  }
  if (!find_trunk(skin, marks)) {
    return missing("trunk and neck");
  }
  if (!find_arm(skin, marks)) {
    return missing("left arm");
  }
  if (!find_leg(skin, marks)) {
    return missing("left leg");
  }
  return marks;
}

std::string describe(const Landmarks& marks) {
  std::string text;
  const auto line = [&](const std::string& name, const Vector3d& p) {
    char buffer[160];
    std::snprintf(buffer, sizeof buffer, "%-10s %8.4f %8.4f %8.4f\n", name.c_str(), p.x(), p.y(), p.z());
    text += buffer;
  };
  line("stature", {0, marks.stature, 0});
  line("eye", marks.eye);
  line("eye_radius", {marks.eye_radius, 0, 0});
  line("skull", marks.skull);
  line("neck_base", marks.neck_base);
  line("sternum", marks.sternum);
  const char* discs[] = {"l5_s1", "l3_l4", "t12_l1", "t7_t8"};
  for (std::size_t i = 0; i < marks.spine.size(); ++i) {
    line(discs[i], marks.spine[i]);
  }
  line("shoulder", marks.shoulder);
  line("elbow", marks.elbow);
  line("wrist", marks.wrist);
  line("knuckle", marks.knuckle);
  line("fingertip", marks.fingertip);
  line("palm", marks.palm);
  line("hip", marks.hip);
  line("knee", marks.knee);
  line("ankle", marks.ankle);
  line("ball", marks.ball);
  line("toe", marks.toe);
  line("heel", marks.heel);
  return text;
}

}  // namespace figure
