#pragma once

#include <string_view>

#include "manipulators/face_fem/factor.h"
#include "manipulators/face_fem/model.h"

namespace face {

/// Large deformation of the same model: the stable neo-Hookean energy of Smith, de Goes and Kim (2018),
///   mu/2 (I_C - 3) + lambda/2 (J - alpha)^2 - mu/2 log(I_C + 1),
/// whose constants are matched so that it has Lame's constants at rest. It is finite for inverted elements, so the
/// search can pass through them. bbar replaces J by its mean over the element, in such a way that small loads give
/// the linear bbar answer; hex8, hex20 and hex20r take J pointwise.
/// Minimised by Newton's method: exact Hessian near the answer, its positive part farther away (by the singular
/// values of the deformation gradient), line search on the energy. Loads are dead: they keep their direction.
struct NonlinearOptions {
  double tolerance = 1e-8;   ///< on the force that is left, relative to loads and reactions
  int most_iterations = 60;  ///< within an increment; when passed, the increment is halved
  int increments = 0;        ///< equal parts of load and shift; 0: one, and one for each 5 degrees that a bone turns
  int most_halvings = 6;
};

enum class Convergence {
  converged,
  increments,  ///< the smallest increment did not converge: `u` is that of the last one that did
};
std::string_view name_of(Convergence convergence);

struct NonlinearSolution {
  Field u;         ///< metres
  Field reaction;  ///< force of the supports on the tissue, newtons, at held axes
  Convergence status = Convergence::converged;
  double reached = 0;   ///< part of load and shift that `u` belongs to, 0..1
  double residual = 0;  ///< force left over the free axes, relative
  double energy = 0;    ///< elastic energy less work of the load, joules
  int increments = 0, iterations = 0;
  double seconds = 0;  ///< CPU time
};

/// Solves with load (newtons, 3 by #nodes) and shift of the supports (3 by #nodes, held axes are read). Errors: those
/// of check() and factoring; `element` for wt, whose bubbles are unstable in large strain.
Result<NonlinearSolution> solve_neo_hookean(const Model& model, const Field& load, const Field& shift,
                                            const NonlinearOptions& options = {});

/// Energy (joules, elastic only), its gradient (internal force, newtons) and its Hessian at displacement u; `project`
/// gives the positive part of the Hessian at each integration point. For tests by finite differences.
struct EnergyState {
  double energy = 0;
  Field force;
  Stiffness hessian;
};
Result<EnergyState> energy_state(const Model& model, const Field& u, bool project);

}  // namespace face
