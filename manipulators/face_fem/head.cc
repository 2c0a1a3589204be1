#include "manipulators/face_fem/head.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cctype>
#include <sstream>

#include "manipulators/mesh/topology.h"

namespace face {
namespace {

/// longer than any head is wide: rays start this far out
constexpr double far_out = 0.6;
/// a head with its neck, from the top down
constexpr double head_height = 0.30;

template <class... Words>
Error refuse(const Words&... words) {
  std::ostringstream text;
  (text << ... << words);
  return {Fault::mesh, text.str()};
}

bool is_eye_part(std::string name) {
  for (char& c : name) c = char(std::tolower(static_cast<unsigned char>(c)));
  const auto has = [&](const char* word) { return name.find(word) != std::string::npos; };
  return (has("eye") || has("sclera") || has("iris")) && !has("lash") && !has("brow") && !has("lid");
}

Eigen::Vector3d place_of(const mesh::Surface& surface, Eigen::Index v) {
  return surface.V.row(v).transpose().cast<double>();
}

/// Least-squares sphere through points: |x|^2 = 2 c.x + (r^2 - c.c) is linear in c and the bracket.
std::optional<Eyeball> sphere_of(const mesh::Surface& ball) {
  const Eigen::Index n = ball.V.rows();
  if (n < 30) return std::nullopt;
  const Eigen::Vector3d mean = ball.V.colwise().mean().transpose().cast<double>();
  Eigen::MatrixX4d A(n, 4);
  Eigen::VectorXd b(n);
  for (Eigen::Index v = 0; v < n; ++v) {
    const Eigen::Vector3d p = place_of(ball, v) - mean;
    A.row(v) << 2 * p.transpose(), 1;
    b[v] = p.squaredNorm();
  }
  const Eigen::Vector4d x = A.colPivHouseholderQr().solve(b);
  const double r = std::sqrt(std::max(0.0, x[3] + x.head<3>().squaredNorm()));
  double miss = 0;
  for (Eigen::Index v = 0; v < n; ++v)
    miss += std::abs((place_of(ball, v) - mean - x.head<3>()).norm() - r) / double(n);
  if (!(r > 0.008 && r < 0.018) || miss > 0.08 * r) return std::nullopt;
  return Eyeball{mean + x.head<3>(), r};
}

std::vector<mesh::Surface> pieces(const mesh::Surface& surface) {
  const std::vector<int> number = mesh::components(surface);
  const int count = number.empty() ? 0 : 1 + *std::max_element(number.begin(), number.end());
  std::vector<mesh::Surface> all;
  for (int c = 0; c < count; ++c) {
    std::vector<bool> keep(number.size());
    for (std::size_t f = 0; f < number.size(); ++f) keep[f] = number[f] == c;
    all.push_back(mesh::subset(surface, keep));
  }
  return all;
}

/// faces of the connected part with the largest area
std::vector<bool> largest_part(const mesh::Surface& surface) {
  const std::vector<int> number = mesh::components(surface);
  std::vector<double> area(number.empty() ? 1 : 1 + *std::max_element(number.begin(), number.end()), 0);
  for (std::size_t f = 0; f < number.size(); ++f) {
    const Eigen::RowVector3i corner = surface.F.row(Eigen::Index(f));
    const Eigen::Vector3d a = place_of(surface, corner[0]);
    area[number[f]] += (place_of(surface, corner[1]) - a).cross(place_of(surface, corner[2]) - a).norm() / 2;
  }
  const int best = int(std::max_element(area.begin(), area.end()) - area.begin());
  std::vector<bool> keep(number.size());
  for (std::size_t f = 0; f < number.size(); ++f) keep[f] = number[f] == best;
  return keep;
}

}  // namespace

Result<Head> Head::take(const mesh::Surface& surface) {
  if (!surface.V.allFinite()) return Error{Fault::not_finite, "a head needs finite vertices"};
  std::vector<bool> is_eye(surface.F.rows()), is_skin(surface.F.rows());
  for (Eigen::Index f = 0; f < surface.F.rows(); ++f) {
    is_eye[f] = is_eye_part(surface.part_names[surface.part[f]]);
    is_skin[f] = !is_eye[f];
  }
  std::vector<int> of_rest, of_skin;
  const mesh::Surface rest = mesh::subset(surface, is_skin, &of_rest);
  if (rest.F.rows() == 0) return refuse("a head needs faces, has none beside eyeballs");
  const mesh::Surface all = mesh::subset(rest, largest_part(rest), &of_skin);

  Head head;
  head.top_ = all.V.col(1).maxCoeff();
  const double bottom = head.top_ - head_height;
  std::vector<bool> near(all.F.rows());
  for (Eigen::Index f = 0; f < all.F.rows(); ++f) {
    near[f] = true;
    for (int k = 0; k < 3; ++k) near[f] = near[f] && all.V(all.F(f, k), 1) > bottom;
  }
  std::vector<int> of_near;
  head.skin_ = std::make_unique<mesh::Surface>(mesh::subset(all, near, &of_near));
  for (int v : of_near) head.vertex_.push_back(of_rest[of_skin[v]]);
  if (head.skin_->V.rows() < 500)
    return refuse("a head needs at least 500 vertices within 0.30 m of its top, has ", head.skin_->V.rows(),
                  "; a finer mesh, or another unit of length, is needed");
  const mesh::Bounds box = mesh::bounds(*head.skin_);
  const double width = box.upper.x() - box.lower.x();
  if (!(width > 0.08 && box.upper.y() - box.lower.y() > 0.12))
    return refuse("a head in metres is 0.12 to 0.30 m wide, this one is ", width, " m; give the unit of the file");

  head.back_ = box.lower.z();
  // the middle plane: mean of both sides over the upper head, where neither ears nor arms reach
  double sum = 0;
  int levels = 0;
  for (double y = head.top_ - 0.10; y < head.top_ - 0.03; y += 0.005) {
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (Eigen::Index v = 0; v < head.skin_->V.rows(); ++v)
      if (std::abs(head.skin_->V(v, 1) - y) < 0.005) {
        low = std::min(low, double(head.skin_->V(v, 0)));
        high = std::max(high, double(head.skin_->V(v, 0)));
      }
    if (high > low) sum += (low + high) / 2, ++levels;
  }
  head.middle_ = levels > 0 ? sum / levels : (box.lower.x() + box.upper.x()) / 2;
  head.tree_ = std::make_unique<mesh::Tree>(head.skin_->V, head.skin_->F);
  // a mask or a scan of the face has no skin behind its middle
  const double centre = head.skin_->V.col(2).cast<double>().mean();
  int behind = 0;
  for (int k = 1; k <= 5; ++k)
    behind += head.outermost({head.middle_, head.top_ - 0.02 * k, centre}, -Eigen::Vector3d::UnitZ()).has_value();
  head.closed_ = behind >= 3;
  if (!head.closed_) {
    // a scan may be cut unevenly, so its sides tell nothing: x = 0, or the nose where that is far off
    float nose = -HUGE_VALF;
    const double low = box.lower.y() + 0.33 * (head.top_ - box.lower.y());
    const double high = box.lower.y() + 0.67 * (head.top_ - box.lower.y());
    for (Eigen::Index v = 0; v < head.skin_->V.rows(); ++v)
      if (head.skin_->V(v, 1) > low && head.skin_->V(v, 1) < high && head.skin_->V(v, 2) > nose) {
        nose = head.skin_->V(v, 2);
        head.middle_ = std::abs(head.skin_->V(v, 0)) < 0.008F ? 0 : double(head.skin_->V(v, 0));
      }
  }

  for (const mesh::Surface& piece : pieces(mesh::subset(surface, is_eye))) {
    const std::optional<Eyeball> ball = sphere_of(piece);
    if (!ball) continue;
    // cornea and iris may be balls of their own: the largest is the eye
    auto& slot = head.eyeballs_[ball->centre.x() > head.middle_ ? 0 : 1];
    if (!slot || ball->radius > slot->radius) slot = ball;
  }
  return head;
}

std::optional<double> Head::outermost(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const {
  // modelled heads have edges in their middle plane: a ray a hair beside it cannot slip between two faces
  const Eigen::Vector3d hair(1.7e-5, 0.9e-5, 1.3e-5);
  const mesh::Tree::Hit hit = tree_->first_hit(origin + far_out * direction + hair, origin + hair);
  if (hit.face < 0) return std::nullopt;
  // the inside of the skin is seen through a hole
  const Eigen::RowVector3i corner = skin_->F.row(hit.face);
  const Eigen::Vector3d a = place_of(*skin_, corner[0]);
  if ((place_of(*skin_, corner[1]) - a).cross(place_of(*skin_, corner[2]) - a).dot(direction) < 0) return std::nullopt;
  return far_out * (1 - hit.share);
}

std::optional<double> Head::front(double x, double y) const {
  const auto reach = outermost({x, y, back_}, Eigen::Vector3d::UnitZ());
  if (!reach) return std::nullopt;
  return back_ + *reach;
}

}  // namespace face
