#pragma once

#include <vector>

#include "manipulators/arm_ik/descent.h"

namespace arm_ik {

/// What no posture reaches, proven. Holds the convex hull of all places that the tool can take, and of all places that
/// the chain's base can take seen from the tool, both a little too large.
///
/// The hull is kept as its support function h(u) = max over postures of u . p. Along a chain it needs one joint at a
/// time: h_k(u) = max over q of w . p_k + h_k+1(w), w the direction u seen from behind joint k at q. A support function
/// is sublinear, so between tabled directions interpolation lies above it, and between two angles of a joint the
/// larger value and a bound of the arc's height do. What is outside the tabled hull is therefore out of reach, whatever
/// the solvers say. For a human arm's far places the bound is within 3 % of what is missed. Building one takes about 10
/// ms, a question 0.1 us.
class Workspace {
 public:
  explicit Workspace(const Packed& chain);

  /// The distance [m] by which every posture misses the goal's place at least; 0 when the place may be reached.
  double distance_bound(const Goal& goal) const;

  /// No posture has the goal's pose (place, when no orientation is asked for). A quick look in one direction each.
  bool excludes_at_once(const Goal& goal) const;
  /// The same, searched for.
  bool excludes(const Goal& goal) const;

 private:
  /// A support function on the sphere, tabled on the faces of an octahedron: values for directions whose components'
  /// absolute values sum to one.
  class Support {
   public:
    Support();
    struct Value {
      double h;
      Eigen::Vector3d point;  // of the tabled hull, the one farthest along u
    };
    double operator()(const Eigen::Vector3d& u) const;
    Value with_point(const Eigen::Vector3d& u) const;
    template <class Function>
    void fill(const Function& of);
    Eigen::Vector3d center() const;

   private:
    struct Face {
      double weight[3], sum;
      int at[3], i, j;
      bool up;
    };
    static Face face_of(const Eigen::Vector3d& u);
    std::vector<double> value_;
  };

  double separation(const Support& hull, const Eigen::Vector3d& place) const;
  Eigen::Vector3d from_base(const Goal& goal) const;
  Eigen::Vector3d base_from_tool(const Goal& goal) const;

  Eigen::Matrix3d base_R_, tool_R_;
  Eigen::Vector3d base_p_, tool_p_;
  Support tool_, base_;  // the tool seen from the base's frame; the base seen from the frame before X_tool
  Eigen::Vector3d tool_center_, base_center_;
  double slack_;
};

}  // namespace arm_ik
