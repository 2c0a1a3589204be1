#include "manipulators/head_ik/solve_command.h"

#include <Eigen/Geometry>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

#include "manipulators/head_ik/control.h"
#include "manipulators/head_ik/figure.h"
#include "manipulators/head_ik/targets.h"

namespace head {
namespace {

std::string row(const Answer& answer) {
  std::string text;
  for (const double angle : {answer.asked.alpha, answer.asked.beta, answer.asked.gamma, answer.limited.alpha,
                             answer.limited.beta, answer.limited.gamma})
    text += number(angle) + ",";
  return text + std::string(answer.status) + "\n";
}

struct Close {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

}  // namespace

Answer answer(const Neck& neck, const Eigen::Matrix3d& R, bool paper) {
  Answer answer;
  answer.asked = zyz(R, paper ? ZyzRule::paper : ZyzRule::two_step);
  // the rounding of a table is taken out before the neck is asked
  const Eigen::Matrix3d clean = Eigen::Quaterniond(R).normalized().toRotationMatrix();
  const Neck::Solution solution = neck.solve(paper ? paper_orientation(R) : clean);
  const bool reached = solution.limit == Limit::none;
  answer.limited = reached && !paper ? answer.asked : zyz(neck.rotation(solution.total));
  answer.status = reached ? "reached" : "limited";
  return answer;
}

int solve_command(const Neck& neck, const SolveOptions& options) {
  const auto read = read_targets(options.targets);
  if (const auto* error = std::get_if<FileError>(&read)) {
    std::fprintf(stderr, "%s\n", error->text.c_str());
    return 1;
  }
  const Targets& targets = std::get<Targets>(read);

  const bool to_file = !options.out.empty() && options.out != "-";
  std::unique_ptr<std::FILE, Close> file(to_file ? std::fopen(options.out.c_str(), "w") : nullptr);
  if (to_file && !file) {
    std::fprintf(stderr, "%s:0:0: error io cannot be written: %s\n", options.out.c_str(), std::strerror(errno));
    return 1;
  }
  std::FILE* const out = to_file ? file.get() : stdout;
  std::fputs("alpha_rad,beta_rad,gamma_rad,limited_alpha_rad,limited_beta_rad,limited_gamma_rad,status\n", out);
  for (const Eigen::Matrix3d& R : targets.orientations) std::fputs(row(answer(neck, R, options.paper)).c_str(), out);
  for (const Eigen::Vector3d& p : targets.points) {
    Answer found;
    if (p.norm() < Control::nearest)
      found.status = name_of(Status::too_near);
    else
      found = answer(neck, donders(gaze(p), options.roll), options.paper);
    std::fputs(row(found).c_str(), out);
  }
  if (std::fflush(out) != 0 || std::ferror(out)) {
    std::fprintf(stderr, "%s:0:0: error io cannot be written: %s\n", to_file ? options.out.c_str() : "standard output",
                 std::strerror(errno));
    return 1;
  }
  return 0;
}

}  // namespace head
