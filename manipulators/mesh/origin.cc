#include "manipulators/mesh/origin.h"

#include <numeric>
#include <string>

namespace mesh {

Origin own_origin(Eigen::Index vertices) {
  Origin origin;
  origin.older = static_cast<int>(vertices);
  origin.first.resize(static_cast<std::size_t>(vertices) + 1);
  origin.vertex.resize(static_cast<std::size_t>(vertices));
  origin.share.assign(static_cast<std::size_t>(vertices), 1);
  std::iota(origin.first.begin(), origin.first.end(), 0);
  std::iota(origin.vertex.begin(), origin.vertex.end(), 0);
  return origin;
}

Result<Follower> Follower::of(const Origin& origin, const std::vector<std::int64_t>& moved) {
  std::vector<int> number(static_cast<std::size_t>(origin.older), -1);
  for (std::size_t k = 0; k < moved.size(); ++k) {
    if (moved[k] < 0 || moved[k] >= origin.older) {
      return Error{"range", "vertex " + std::to_string(moved[k]) + " is none of the surface's " +
                                std::to_string(origin.older) + ", 0 to " + std::to_string(origin.older - 1)};
    }
    int& known = number[static_cast<std::size_t>(moved[k])];
    if (known >= 0) {
      return Error{"range", "vertex " + std::to_string(moved[k]) + " is named twice"};
    }
    known = static_cast<int>(k);
  }
  Follower follower;
  follower.count_ = moved.size();
  for (std::size_t v = 0; v < origin.size(); ++v) {
    const std::size_t before = follower.moved_.size();
    for (int i = origin.first[v]; i < origin.first[v + 1]; ++i) {
      const int k = number[static_cast<std::size_t>(origin.vertex[static_cast<std::size_t>(i)])];
      if (k >= 0) {
        follower.moved_.push_back(k);
        follower.share_.push_back(origin.share[static_cast<std::size_t>(i)]);
      }
    }
    if (follower.moved_.size() > before) {
      follower.vertices_.push_back(static_cast<int>(v));
      follower.first_.push_back(static_cast<int>(follower.moved_.size()));
    }
  }
  return follower;
}

void Follower::add(const double* displacement, Eigen::MatrixX3f& V) const {
  for (std::size_t j = 0; j < vertices_.size(); ++j) {
    Eigen::RowVector3f sum = Eigen::RowVector3f::Zero();
    for (int i = first_[j]; i < first_[j + 1]; ++i) {
      const double* d = displacement + 3 * moved_[i];
      sum +=
          share_[i] * Eigen::RowVector3f(static_cast<float>(d[0]), static_cast<float>(d[1]), static_cast<float>(d[2]));
    }
    V.row(vertices_[j]) += sum;
  }
}

}  // namespace mesh
