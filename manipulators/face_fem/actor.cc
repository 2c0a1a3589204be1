#include "manipulators/face_fem/actor.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "manipulators/face_fem/clock.h"
#include "manipulators/face_fem/column_sum.h"
#include "manipulators/face_fem/neo_hookean.h"

namespace face {
namespace {

constexpr std::string_view words[] = {"basis", "contact", "solve", "nonlinear"};

// how far from the eye's centre, in its radii, a vertex may come to lie on it
constexpr double near_eye = 1.6;

// beyond this many columns a sum at the nodes, carried to the vertices, is cheaper
constexpr int most_at_vertices = 16;

// Linear and neo-Hookean answers differ by a hundredth for each millimetre of motion (docs/face.md): this times its
// square, metres
constexpr double linear_error = 10;

}  // namespace

std::string_view name_of(FaceMethod method) { return words[static_cast<std::size_t>(method)]; }

Result<std::unique_ptr<Actor>> Actor::make(Face face) {
  const double start = cpu_seconds();
  std::unique_ptr<Actor> actor(new Actor);
  actor->face_ = std::move(face);
  if (auto status = actor->build(); !status) return status.error();
  actor->setup_seconds_ = cpu_seconds() - start;
  return actor;
}

Status Actor::build() {
  Model& model = face_.model;
  std::vector<bool> held(model.nodes.size(), false);
  for (const Support& support : model.supports) held[std::size_t(support.node)] = true;

  // the lids are bones of their own, moved along the eyeballs
  const int lid_bone = int(model.bones.size());
  model.bones.push_back("lids");
  for (std::size_t side : {0, 1}) {
    lids_.emplace_back(model, face_.lids[side], face_.eyes[side], face_.jaw.axis, held);
    for (int lid : {0, 1})
      for (int node : lids_.back().nodes(lid)) {
        Support support;
        support.node = node;
        support.bone = lid_bone;
        model.supports.push_back(support);
        held[std::size_t(node)] = true;
      }
  }

  auto statics = Statics::make(model);
  if (!statics) return statics.error();
  statics_.emplace(std::move(*statics));
  boxes_ = std::make_unique<ElementBoxes>(model);
  basis_ = std::make_unique<Basis>(*statics_, face_.carrier.nodes());
  strain_ = std::make_unique<StrainWatch>(model);

  muscles_ = face_.muscles;
  for (const Muscle& muscle : muscles_) {
    auto load = load_of(model, *boxes_, muscle);
    if (!load) return load.error();
    loads_.push_back(std::move(load->load));
  }
  const int first = basis_->add(loads_);
  for (int m = 0; m < muscles(); ++m) column_.push_back(first + m);

  Field sine = Field::Zero(3, Eigen::Index(model.nodes.size())), cosine = sine, thrust = sine;
  const Eigen::Vector3d& axis = face_.jaw.axis;
  for (const Support& support : model.supports) {
    if (support.bone != face_.jaw_bone) continue;
    const Eigen::Vector3d r = model.nodes[std::size_t(support.node)] - face_.jaw.centre;
    sine.col(support.node) = axis.cross(r);
    cosine.col(support.node) = axis.cross(axis.cross(r));
    thrust.col(support.node) = Eigen::Vector3d::UnitZ();
  }
  places_.jaw_sine = basis_->add_shift(sine);
  places_.jaw_cosine = basis_->add_shift(cosine);
  places_.thrust = basis_->add_shift(thrust);
  for (std::size_t side : {0, 1})
    for (int lid : {0, 1}) {
      places_.lid[side][std::size_t(lid)] = basis_->columns();
      for (const double part : lid == 0 ? LidPath::upper_samples : LidPath::lower_samples) {
        Field shift = Field::Zero(3, Eigen::Index(model.nodes.size()));
        const Eigen::Matrix3Xd way = lids_[side].shift(lid, part);
        for (std::size_t k = 0; k < lids_[side].nodes(lid).size(); ++k)
          shift.col(lids_[side].nodes(lid)[k]) = way.col(Eigen::Index(k));
        basis_->add_shift(shift);
      }
    }
  lips_ = std::make_unique<LipContact>(model, face_.lips, held, *basis_);
  places_.lips = lips_->first_column();
  for (int c = 0; c < basis_->columns(); ++c) strain_->read(model, basis_->column(c), c);
  for (int c = 0; c < places_.lips; ++c) keep_at_vertices(c);
  return success();
}

Status Actor::set_muscle(int m, const Muscle& muscle) {
  auto load = load_of(face_.model, *boxes_, muscle);
  if (!load) return load.error();
  if (m == muscles()) {
    muscles_.push_back(muscle);
    column_.push_back(basis_->add({load->load}));
    loads_.push_back(std::move(load->load));
  } else {
    muscles_[std::size_t(m)] = muscle;
    basis_->replace(column_[std::size_t(m)], load->load);
    loads_[std::size_t(m)] = std::move(load->load);
  }
  const int column = column_[std::size_t(m)];
  lips_->read(*basis_, column);
  strain_->read(face_.model, basis_->column(column), column);
  keep_at_vertices(column);
  return success();
}

void Actor::keep_at_vertices(int column) {
  if (int(at_vertices_.size()) <= column) at_vertices_.resize(std::size_t(column) + 1);
  carry(basis_->column(column), at_vertices_[std::size_t(column)]);
}

std::vector<double> Actor::amounts(const Drive& drive) const {
  std::vector<double> amounts(std::size_t(basis_->columns()), 0.0);
  const std::size_t count = std::min(drive.activation.size(), column_.size());
  for (std::size_t m = 0; m < count; ++m) amounts[std::size_t(column_[m])] = drive.activation[m];
  amounts[std::size_t(places_.jaw_sine)] = std::sin(drive.jaw);
  amounts[std::size_t(places_.jaw_cosine)] = 1 - std::cos(drive.jaw);
  amounts[std::size_t(places_.thrust)] = drive.thrust;
  for (std::size_t side : {0, 1})
    for (std::size_t lid : {0, 1}) {
      const auto weights = LidPath::weights(int(lid), lid == 0 ? drive.lids[side].upper : drive.lids[side].lower);
      for (std::size_t k = 0; k < LidPath::samples; ++k) amounts[std::size_t(places_.lid[side][lid]) + k] = weights[k];
    }
  return amounts;
}

void Actor::press(const Drive& drive, std::vector<double>& amounts, Frame* frame) const {
  const bool still = std::all_of(amounts.begin(), amounts.end(), [](double amount) { return amount == 0; });
  if (still) return;
  const LipContact::Answer answer = lips_->solve(amounts.data(), lip_tone * (1 - drive.part));
  for (int i = 0; i < lips_->pairs(); ++i) amounts[std::size_t(places_.lips + i)] = answer.force[i];
  if (frame == nullptr) return;
  frame->lip_gap = answer.deepest;
  frame->lip_force = answer.pressed;
  frame->sweeps = answer.sweeps;
  frame->converged = answer.converged;
}

Field Actor::jaw_shift(double angle, double thrust) const {
  Field shift = Field::Zero(3, Eigen::Index(face_.model.nodes.size()));
  const Eigen::Matrix3d R = Eigen::AngleAxisd(angle, face_.jaw.axis).toRotationMatrix();
  for (const Support& support : face_.model.supports) {
    if (support.bone != face_.jaw_bone) continue;
    const Eigen::Vector3d r = face_.model.nodes[std::size_t(support.node)] - face_.jaw.centre;
    shift.col(support.node) = R * r - r + thrust * Eigen::Vector3d::UnitZ();
  }
  return shift;
}

Field Actor::shift_of(const Drive& drive) const {
  Field shift = jaw_shift(drive.jaw, drive.thrust);
  for (std::size_t side : {0, 1})
    for (int lid : {0, 1}) {
      const std::vector<int>& nodes = lids_[side].nodes(lid);
      const Eigen::Matrix3Xd way = lids_[side].shift(lid, lid == 0 ? drive.lids[side].upper : drive.lids[side].lower);
      for (std::size_t k = 0; k < nodes.size(); ++k) shift.col(nodes[k]) = way.col(Eigen::Index(k));
    }
  return shift;
}

Field Actor::load_of_all(const Drive& drive) const {
  Field load = Field::Zero(3, Eigen::Index(face_.model.nodes.size()));
  for (std::size_t m = 0; m < std::min(drive.activation.size(), loads_.size()); ++m)
    if (drive.activation[m] != 0) load += drive.activation[m] * loads_[m];
  return load;
}

void Actor::carry(const Field& u, std::vector<float>& displacement) const {
  std::vector<float> nodes;
  nodes.reserve(3 * face_.carrier.nodes().size());
  for (int node : face_.carrier.nodes())
    for (int i = 0; i < 3; ++i) nodes.push_back(float(u(i, node)));
  displacement.resize(3 * vertices().size());
  face_.carrier.carry(nodes.data(), displacement.data());
}

// A few columns are summed at the vertices; many, such as those of the lips, at the nodes, which are fewer but have to
// be carried then.
void Actor::sum_columns(const std::vector<double>& amounts, std::vector<float>& displacement) const {
  std::vector<const float*> active;
  std::vector<float> amount;
  bool lips = false;
  for (std::size_t c = 0; c < amounts.size(); ++c) {
    if (amounts[c] == 0) continue;
    lips = lips || c >= at_vertices_.size() || at_vertices_[c].empty();
    if (lips) break;
    active.push_back(at_vertices_[c].data());
    amount.push_back(float(amounts[c]));
  }
  displacement.assign(3 * vertices().size(), 0.0f);
  if (!lips && int(active.size()) <= most_at_vertices) {
    add_columns(active.data(), amount.data(), int(active.size()), displacement.size(), displacement.data());
    return;
  }
  std::vector<float> nodes(3 * face_.carrier.nodes().size());
  basis_->frame(amounts.data(), nodes.data());
  face_.carrier.carry(nodes.data(), displacement.data());
}

Frame Actor::frame(const Drive& drive, FaceMethod method) const {
  Frame frame;
  frame.jaw = drive.jaw;
  std::vector<double> sums = amounts(drive);
  if (method == FaceMethod::nonlinear) {
    const auto answer = solve_neo_hookean(face_.model, load_of_all(drive), shift_of(drive));
    // refused only for what Statics::make refused before
    if (!answer) {
      frame.converged = false;
      frame.reached = 0;
      frame.displacement.assign(3 * vertices().size(), 0.0f);
      return frame;
    }
    frame.converged = answer->status == Convergence::converged;
    frame.reached = answer->reached;
    frame.iterations = answer->iterations;
    frame.validity = validity_of(face_.model, answer->u);
    carry(answer->u, frame.displacement);
    keep_clear_of_eyes(frame.displacement);
    return frame;
  }
  if (method != FaceMethod::basis) press(drive, sums, &frame);
  if (method == FaceMethod::solve) {
    carry(field(drive, method), frame.displacement);
  } else {
    sum_columns(sums, frame.displacement);
  }
  double farthest = 0;
  for (std::size_t v = 0; v + 2 < frame.displacement.size(); v += 3)
    farthest = std::max(farthest, double(Eigen::Map<const Eigen::Vector3f>(&frame.displacement[v]).squaredNorm()));
  frame.error = linear_error * farthest;
  if (method == FaceMethod::basis) return frame;
  keep_clear_of_eyes(frame.displacement);
  frame.validity = strain_->measure(sums);
  frame.validity.bone_turn = std::abs(drive.jaw);
  frame.validity.turned_bone = face_.jaw_bone;
  return frame;
}

Field Actor::field(const Drive& drive, FaceMethod method) const {
  std::vector<double> sums = amounts(drive);
  if (method != FaceMethod::basis) press(drive, sums, nullptr);
  if (method != FaceMethod::solve) return basis_->field(sums.data());
  Field load = load_of_all(drive);
  for (int i = 0; i < lips_->pairs(); ++i) lips_->add_load(i, sums[std::size_t(places_.lips + i)], load);
  return statics_->solve(load, shift_of(drive)).u;
}

Validity Actor::validity(const Drive& drive) const { return validity_of(face_.model, field(drive)); }

void Actor::keep_clear_of_eyes(std::vector<float>& displacement) const {
  for (const Near& vertex : near_) {
    Eigen::Map<Eigen::Vector3f> d(&displacement[std::size_t(3 * vertex.place)]);
    const Eigen::Vector3f at = vertex.rest + d;
    const float distance = at.norm();
    if (distance >= vertex.clear || distance == 0) continue;
    d = at * (vertex.clear / distance) - vertex.rest;
  }
}

void Actor::set_surface(const Eigen::MatrixX3f& V) {
  near_.clear();
  for (std::size_t k = 0; k < vertices().size(); ++k)
    for (int eye : {0, 1}) {
      const Eyeball& ball = face_.eyes[std::size_t(eye)];
      const Eigen::Vector3f rest = V.row(vertices()[k]).transpose() - ball.centre.cast<float>();
      const double distance = rest.norm();
      if (distance > near_eye * ball.radius || rest.z() < 0) continue;
      // what lies inside at rest, as the inner side of a lid may, need not come out
      near_.push_back({int(k), rest, float(std::min(distance, ball.radius * 1.02))});
    }
}

}  // namespace face
