#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "manipulators/mesh/result.h"

namespace mesh {

/// Of which vertices of an older surface those of a newer one are made: vertex v is the mix of `vertex[i]` by
/// `share[i]` for first[v] <= i < first[v + 1]. The shares of a vertex are positive and sum to one, or it has none.
struct Origin {
  std::vector<int> first = {0};  ///< #V + 1, rising
  std::vector<int> vertex;       ///< in [0, older)
  std::vector<float> share;
  int older = 0;  ///< number of vertices of the older surface

  std::size_t size() const { return first.size() - 1; }
};

/// The origin of a surface that was not cut: each of its `vertices` is itself.
Origin own_origin(Eigen::Index vertices);

/// What goes along when certain vertices of the older surface are moved: constant once made.
class Follower {
 public:
  /// `moved`: numbers of vertices of the older surface. Errors: `range` a number that is none, or that comes twice.
  static Result<Follower> of(const Origin& origin, const std::vector<std::int64_t>& moved);

  /// Adds to `V` (#V by 3) what each vertex moves by when `moved[k]` moves by displacement[3k .. 3k+2].
  void add(const double* displacement, Eigen::MatrixX3f& V) const;
  /// The vertices that move, rising.
  const std::vector<int>& vertices() const { return vertices_; }
  /// How many vertices of the older surface move it.
  std::size_t moved() const { return count_; }

 private:
  std::size_t count_ = 0;
  std::vector<int> vertices_;
  std::vector<int> first_ = {0};  ///< as in Origin, for vertices_
  std::vector<int> moved_;        ///< index into `moved`
  std::vector<float> share_;
};

}  // namespace mesh
