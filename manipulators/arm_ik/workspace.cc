#include "manipulators/arm_ik/workspace.h"

#include <algorithm>
#include <cmath>

namespace arm_ik {

namespace {

using Eigen::Vector3d;

constexpr int steps = 24;                   // of an octahedron's edge
constexpr int row = steps + 1;              // a face in a square of values
constexpr double finest_angle = M_PI / 60;  // between two angles of a joint
constexpr int most_angles = 64;             // of a full turn
constexpr int ascents = 12;                 // steps of the search for a separating direction
constexpr double rounding = 1e-9;           // of the reach

struct Turn {
  double s, c;
};

// the same bits everywhere, unlike the mathematics library
Turn turn_of(double angle) {
  Lanes<1>::Real s, c;
  sine_cosine<1>(Lanes<1>::Real{angle}, s, c);
  return {s[0], c[0]};
}

/// The turns of one joint, close enough that what lies between two of them is bounded by `height`.
struct Sweep {
  std::vector<Turn> turns;
  double height = 0;  // of the arc over its chord, of radius 1
};

Sweep sweep_of(double lower, double upper) {
  Sweep out;
  const double range = std::min(upper - lower, 2 * M_PI);
  const int parts = std::clamp(static_cast<int>(std::ceil(range / finest_angle)), 1, most_angles);
  for (int k = 0; k <= parts; ++k) out.turns.push_back(turn_of(lower + range * k / parts));
  out.height = 1 - turn_of(0.5 * range / parts).c;
  return out;
}

Vector3d vector_of(const double* three) { return {three[0], three[1], three[2]}; }

Eigen::Matrix3d matrix_of(const double* columns) {
  Eigen::Matrix3d R;
  for (int k = 0; k < 3; ++k) R.col(k) = vector_of(columns + 4 * k);
  return R;
}

}  // namespace

Workspace::Support::Support() : value_(static_cast<std::size_t>(8) * row * row, 0.0) {}

Workspace::Support::Face Workspace::Support::face_of(const Vector3d& u) {
  Face out{};
  const double x = std::abs(u.x()), y = std::abs(u.y());
  out.sum = x + y + std::abs(u.z());
  const double scale = steps / std::max(out.sum, 1e-300);
  int i = static_cast<int>(x * scale), j = static_cast<int>(y * scale);
  // rounding may name a corner beyond the edge
  while (i + j >= steps) --(i > j ? i : j);
  const double a = x * scale - i, b = y * scale - j;
  out.up = a + b <= 1 || i + j == steps - 1;
  const int octant = (u.x() < 0 ? 1 : 0) + (u.y() < 0 ? 2 : 0) + (u.z() < 0 ? 4 : 0);
  const int corner = (octant * row + i) * row + j;
  out.i = i;
  out.j = j;
  if (out.up) {
    out.at[0] = corner, out.at[1] = corner + row, out.at[2] = corner + 1;
    out.weight[0] = 1 - a - b, out.weight[1] = a, out.weight[2] = b;
  } else {
    out.at[0] = corner + row + 1, out.at[1] = corner + 1, out.at[2] = corner + row;
    out.weight[0] = a + b - 1, out.weight[1] = 1 - a, out.weight[2] = 1 - b;
  }
  return out;
}

double Workspace::Support::operator()(const Vector3d& u) const {
  const Face f = face_of(u);
  return f.sum * (f.weight[0] * value_[f.at[0]] + f.weight[1] * value_[f.at[1]] + f.weight[2] * value_[f.at[2]]);
}

Workspace::Support::Value Workspace::Support::with_point(const Vector3d& u) const {
  const Face f = face_of(u);
  const double h0 = value_[f.at[0]], h1 = value_[f.at[1]], h2 = value_[f.at[2]];
  // on one face h is linear: its gradient is the point
  const double side = f.up ? 1 : -1, dx = side * steps * (h1 - h0), dy = side * steps * (h2 - h0);
  const int i = f.up ? f.i : f.i + 1, j = f.up ? f.j : f.j + 1;
  const double z = h0 - (i * dx + j * dy) / steps;
  const Vector3d point(u.x() < 0 ? -(z + dx) : z + dx, u.y() < 0 ? -(z + dy) : z + dy, u.z() < 0 ? -z : z);
  return {f.sum * (f.weight[0] * h0 + f.weight[1] * h1 + f.weight[2] * h2), point};
}

template <class Function>
void Workspace::Support::fill(const Function& of) {
  for (int octant = 0; octant < 8; ++octant) {
    for (int i = 0; i <= steps; ++i) {
      for (int j = 0; i + j <= steps; ++j) {
        const Vector3d u((octant & 1 ? -1.0 : 1.0) * i, (octant & 2 ? -1.0 : 1.0) * j,
                         (octant & 4 ? -1.0 : 1.0) * (steps - i - j));
        value_[static_cast<std::size_t>((octant * row + i) * row + j)] = of(Vector3d(u / steps));
      }
    }
  }
}

Vector3d Workspace::Support::center() const {
  Vector3d out;
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3d u = Vector3d::Unit(axis);
    out[axis] = 0.5 * ((*this)(u) - (*this)(-u));
  }
  return out;
}

Workspace::Workspace(const Packed& chain)
    : base_R_(matrix_of(chain.base)),
      tool_R_(matrix_of(chain.tool)),
      base_p_(vector_of(chain.base + 12)),
      tool_p_(vector_of(chain.tool + 12)),
      slack_(rounding * chain.reach) {
  // outermost first for the tool, innermost first for the base; `arm`: bound of what lies behind a joint
  double arm = tool_p_.norm();
  tool_.fill([&](const Vector3d& u) { return u.dot(tool_p_); });
  const auto slide_bound = [&](int k) { return std::max(std::abs(chain.lower[k]), std::abs(chain.upper[k])); };
  for (int k = chain.n - 1; k >= 0; --k) {
    const Vector3d p(chain.px[k], chain.py[k], chain.pz[k]);
    const double ca = chain.ca[k], sa = chain.sa[k];
    arm += p.norm();
    const Support behind = tool_;
    const auto at = [&](const Vector3d& w) {
      return w.dot(p) + behind(Vector3d(w.x(), ca * w.y() + sa * w.z(), ca * w.z() - sa * w.y()));
    };
    if (chain.turns[k] == 1) {
      const Sweep sweep = sweep_of(chain.offset[k] + chain.lower[k], chain.offset[k] + chain.upper[k]);
      tool_.fill([&](const Vector3d& u) {
        double h = -HUGE_VAL;
        for (const Turn& t : sweep.turns)
          h = std::max(h, at(Vector3d(t.c * u.x() + t.s * u.y(), t.c * u.y() - t.s * u.x(), u.z())));
        return h + sweep.height * std::hypot(u.x(), u.y()) * arm;
      });
    } else {
      const Turn t = turn_of(chain.offset[k]);
      tool_.fill([&](const Vector3d& u) {
        const double along = std::max(chain.lower[k] * u.z(), chain.upper[k] * u.z());
        return along + at(Vector3d(t.c * u.x() + t.s * u.y(), t.c * u.y() - t.s * u.x(), u.z()));
      });
      arm += slide_bound(k);
    }
  }
  // a joint's frame sees the base as the frame before does, turned back and moved by -p
  arm = 0;
  for (int k = 0; k < chain.n; ++k) {
    const Vector3d p(chain.px[k], chain.py[k], chain.pz[k]);
    const double ca = chain.ca[k], sa = chain.sa[k];
    const Support before = base_;
    const bool turns = chain.turns[k] == 1;
    const Sweep sweep = turns ? sweep_of(chain.offset[k] + chain.lower[k], chain.offset[k] + chain.upper[k])
                              : sweep_of(chain.offset[k], chain.offset[k]);
    base_.fill([&](const Vector3d& u) {
      const Vector3d w(u.x(), ca * u.y() - sa * u.z(), sa * u.y() + ca * u.z());
      double h = -HUGE_VAL;
      for (const Turn& t : sweep.turns)
        h = std::max(h, before(Vector3d(t.c * w.x() - t.s * w.y(), t.s * w.x() + t.c * w.y(), w.z())));
      h += sweep.height * std::hypot(w.x(), w.y()) * arm - w.dot(p);
      return turns ? h : h + std::max(-chain.lower[k] * w.z(), -chain.upper[k] * w.z());
    });
    arm += p.norm() + (turns ? 0 : slide_bound(k));
  }
  tool_center_ = tool_.center();
  base_center_ = base_.center();
}

Vector3d Workspace::from_base(const Goal& goal) const {
  return base_R_.transpose() * (vector_of(goal.frame + 12) - base_p_);
}

Vector3d Workspace::base_from_tool(const Goal& goal) const {
  const Eigen::Matrix3d R = matrix_of(goal.frame);
  // X_tool stands between the last joint's frame and the goal
  return tool_R_ * (R.transpose() * (base_p_ - vector_of(goal.frame + 12))) + tool_p_;
}

// the largest u . place - h(u) that a few steps uphill find; more than 0 separates the two
double Workspace::separation(const Support& hull, const Vector3d& place) const {
  Vector3d u = place - hull.center();
  if (!(u.norm() > 0)) return 0;
  u.normalize();
  double most = -HUGE_VAL, pace = 1;
  for (int k = 0; k < ascents; ++k) {
    const Support::Value at = hull.with_point(u);
    most = std::max(most, u.dot(place) - at.h);
    const Vector3d gap = place - at.point;
    if (!(gap.norm() > 0)) break;
    u = (u + pace * gap.normalized()).normalized();
    pace *= 0.7;
  }
  return most - slack_;
}

double Workspace::distance_bound(const Goal& goal) const { return std::max(0.0, separation(tool_, from_base(goal))); }

bool Workspace::excludes_at_once(const Goal& goal) const {
  const auto outside = [&](const Support& hull, const Vector3d& place, const Vector3d& center) {
    const Vector3d u = place - center;
    return u.dot(place) > hull(u) + slack_ * u.norm();
  };
  return outside(tool_, from_base(goal), tool_center_) ||
         (goal.pose && outside(base_, base_from_tool(goal), base_center_));
}

bool Workspace::excludes(const Goal& goal) const {
  return separation(tool_, from_base(goal)) > 0 || (goal.pose && separation(base_, base_from_tool(goal)) > 0);
}

}  // namespace arm_ik
