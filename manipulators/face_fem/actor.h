#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "manipulators/face_fem/drive.h"
#include "manipulators/face_fem/face.h"
#include "manipulators/face_fem/lids.h"
#include "manipulators/face_fem/lips.h"
#include "manipulators/face_fem/statics.h"
#include "manipulators/face_fem/strain_watch.h"

namespace face {

/// How a frame is found, from cheap to dear.
enum class FaceMethod {
  basis,      ///< weighted sum of solved columns, nothing else: lips may cross, nothing is measured
  contact,    ///< the same with lips that touch and stay sealed, lids clear of the eyes, strain measured
  solve,      ///< the same answer from a full linear solve, for comparison
  nonlinear,  ///< neo-Hookean tissue, Newton's method; no lip contact
};
constexpr std::array<FaceMethod, 4> all_face_methods = {FaceMethod::basis, FaceMethod::contact, FaceMethod::solve,
                                                        FaceMethod::nonlinear};
std::string_view name_of(FaceMethod method);

/// What became of a frame.
struct Frame {
  std::vector<float> displacement;  ///< of Actor::vertices(), x y z in turn, metres
  Validity validity;                ///< at the middles of the elements; whole for nonlinear
  double error = 0;                 ///< largest error that the method knows of, metres
  double jaw = 0;                   ///< radians
  double lip_gap = 0;               ///< metres: penetration that is left
  double lip_force = 0;             ///< newtons that press the lips together
  int sweeps = 0;                   ///< of the contact
  int iterations = 0;               ///< Newton steps
  bool converged = true;
  double reached = 1;  ///< part of the motion that the nonlinear method reached
};

/// A face that is ready to move: columns for every muscle, for the jaw's opening (the sine and the 1 - cosine of its
/// angle, so that bone nodes go round the hinge exactly), for its thrust, for the lids, for the lips' pairs.
class Actor {
 public:
  /// Errors: those of Statics::make and load_of.
  static Result<std::unique_ptr<Actor>> make(Face face);

  const Face& face() const { return face_; }
  const Statics& statics() const { return *statics_; }
  const std::vector<int>& vertices() const { return face_.carrier.vertices(); }
  int muscles() const { return int(muscles_.size()); }
  const Muscle& muscle(int m) const { return muscles_[std::size_t(m)]; }
  std::array<double, 2> aperture() const { return {lids_[0].aperture(), lids_[1].aperture()}; }

  /// Another muscle in place of number m, or one more when m is muscles(): one solve. Errors: those of load_of;
  /// nothing is changed then.
  Status set_muscle(int m, const Muscle& muscle);

  /// The frame for a drive; `activation` may be longer than Face::muscles by those that were added. The basis is
  /// found by sums; `solve` and `nonlinear` solve the model anew, which takes milliseconds and seconds.
  Frame frame(const Drive& drive, FaceMethod method) const;

  /// Displacement of all nodes for the same drive (linear), metres; and the whole measure of it.
  Field field(const Drive& drive, FaceMethod method = FaceMethod::contact) const;
  Validity validity(const Drive& drive) const;

  /// The head's vertices at rest, #V by 3: from then on frames keep those near an eyeball outside it.
  void set_surface(const Eigen::MatrixX3f& V);

  double setup_seconds() const { return setup_seconds_; }

  /// Newtons that a pair of lip nodes holds when the mouth is sealed.
  static constexpr double lip_tone = 0.02;

 private:
  Actor() = default;
  Status build();
  Field jaw_shift(double angle, double thrust) const;
  Field shift_of(const Drive& drive) const;
  Field load_of_all(const Drive& drive) const;
  std::vector<double> amounts(const Drive& drive) const;
  void press(const Drive& drive, std::vector<double>& amounts, Frame* frame) const;
  void sum_columns(const std::vector<double>& amounts, std::vector<float>& displacement) const;
  void keep_at_vertices(int column);
  void keep_clear_of_eyes(std::vector<float>& displacement) const;
  void carry(const Field& u, std::vector<float>& displacement) const;

  // where an amount stands among the columns; muscles that were added come after the others
  struct Places {
    int jaw_sine = 0, jaw_cosine = 0, thrust = 0;
    std::array<std::array<int, 2>, 2> lid{};  // first column by eye and lid
    int lips = 0;
  };

  Face face_;
  std::optional<Statics> statics_;
  std::unique_ptr<ElementBoxes> boxes_;
  std::vector<Muscle> muscles_;
  std::vector<Field> loads_;  // by muscle
  std::vector<int> column_;   // by muscle
  std::vector<LidPath> lids_;
  std::unique_ptr<Basis> basis_;
  // columns carried to the vertices, for few of them at a time; none for those of the lips
  std::vector<std::vector<float>> at_vertices_;
  std::unique_ptr<LipContact> lips_;
  std::unique_ptr<StrainWatch> strain_;
  Places places_;
  struct Near {
    int place;             // in vertices()
    Eigen::Vector3f rest;  // from the eye's centre
    float clear;           // distance that is kept
  };
  std::vector<Near> near_;
  double setup_seconds_ = 0;
};

}  // namespace face
