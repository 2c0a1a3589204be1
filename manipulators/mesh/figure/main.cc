#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "manipulators/mesh/figure/script.h"
#include "manipulators/mesh/read.h"
#include "manipulators/mesh/write.h"

namespace {

/// How far the skull stands above C7-T1, up and forward, in a neck of scale 1 as head_ik prints it.
Eigen::Vector3d rise_of(const std::vector<figure::Part>& neck) {
  Eigen::Vector3d rise = Eigen::Vector3d::Zero();
  for (const figure::Part& part : neck) {
    rise += Eigen::Vector3d(0, part.dh.d, -part.dh.a);
  }
  return rise;
}

std::string text_of(const std::string& path) {
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

bool save(const std::filesystem::path& path, const std::string& text) {
  std::ofstream file(path);
  file << text;
  file.close();
  if (!file) {
    std::fprintf(stderr, "figure: error io %s cannot be written\n", path.c_str());
  }
  return static_cast<bool>(file);
}

int refuse(const mesh::Error& error) {
  std::fprintf(stderr, "figure: error %s %s\n", error.kind.c_str(), error.sentence.c_str());
  return 1;
}

bool save_worn(const std::filesystem::path& folder, const mesh::Surface& body, const figure::Landmarks& marks) {
  const mesh::Surface shoe = figure::shoe(body, marks);
  const std::pair<const char*, mesh::Surface> worn[] = {
      {"cap.obj", figure::cap(marks)}, {"left_shoe.obj", shoe}, {"right_shoe.obj", figure::mirror_image(shoe)}};
  for (const auto& [name, surface] : worn) {
    if (const auto written = mesh::write_surface((folder / name).string(), surface); !written) {
      refuse(written.error());
      return false;
    }
  }
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"figure: fits the skeleton to a body and writes the scripts that build the sailor"};
  std::string file = "/usr/share/assimp/models/Collada/human.zae";
  std::string neck_file;
  std::string folder;
  bool print_landmarks = false;
  bool print_neck = false;
  app.add_option("--body", file, "the body's mesh: closed, on y = 0, facing +Z, arms away from the trunk")
      ->capture_default_str();
  app.add_flag("--landmarks", print_landmarks, "print the joint centres found in the body");
  app.add_option("--neck", neck_file, "neck as `head_ik --figure-neck full` prints it");
  app.add_flag("--neck-options", print_neck,
               "print the options of head_ik that put its neck (of scale 1, --neck) in place");
  app.add_option("--out", folder, "write skeleton.dlg, gaze.dlg, body.dlg, cap.obj and the shoes into this folder");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }

  const auto body = mesh::read_surface(file);
  if (!body) {
    return refuse(body.error());
  }
  const auto marks = figure::find_landmarks(*body);
  if (!marks) {
    return refuse(marks.error());
  }
  if (print_landmarks) {
    std::fputs(figure::describe(*marks).c_str(), stdout);
  }
  if (!print_neck && folder.empty()) {
    return 0;
  }
  const auto neck = figure::read_parts(text_of(neck_file));
  if (!neck || neck->empty()) {
    return refuse(neck ? mesh::Error{"io", "no neck in " + (neck_file.empty() ? "--neck (not given)" : neck_file)}
                       : neck.error());
  }
  if (print_neck) {
    const figure::NeckPlace place = figure::neck_place(*marks, rise_of(*neck));
    std::printf("--scale %s --position %s %s %s\n", figure::number(place.scale).c_str(),
                figure::number(place.position.x()).c_str(), figure::number(place.position.y()).c_str(),
                figure::number(place.position.z()).c_str());
  }
  if (!folder.empty()) {
    const figure::Skeleton skeleton = figure::make_skeleton(*marks, *neck);
    const std::filesystem::path out(folder);
    const bool written = save(out / "skeleton.dlg", figure::skeleton_script(skeleton, *marks)) &&
                         save(out / "gaze.dlg", figure::gaze_script(*marks)) &&
                         save(out / "body.dlg", figure::body_script(skeleton, *marks, file)) &&
                         save_worn(out, *body, *marks);
    return written ? 0 : 1;
  }
  return 0;
}
