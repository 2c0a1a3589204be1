#include <CLI/CLI.hpp>
#include <cstdio>

#include "manipulators/kit/manipulator.h"
#include "manipulators/render/declaration.h"
#include "manipulators/render/look.h"
#include "manipulators/render/service.h"
#include "manipulators/render/world_file.h"

namespace {

// one picture of a saved world, without a dialog manager
int draw(const std::string& scene, const std::string& picture_file, const std::string& camera, const std::string& size,
         const std::string& quality) {
  objdb::Database world;
  std::string problem = render::declare_types(render::declaration, world);
  if (problem.empty()) problem = render::read_world(scene, world);
  if (!problem.empty()) {
    std::fprintf(stderr, "%s\n", problem.c_str());
    return 1;
  }
  std::vector<objdb::Word> words = {{picture_file, 1, true}};
  auto add = [&](std::string_view keyword, const std::string& value) {
    if (value.empty()) return;
    words.push_back({keyword, 1, false});
    words.push_back({value, 1, false});
  };
  add("from", camera);
  add("size", size);
  add("quality", quality);
  auto request = render::parse_request(world, words, {"from", "size", "quality"});
  if (!request) {
    std::fprintf(stderr, "render: error %s %s\n", std::string(objdb::name_of(request.error().kind)).c_str(),
                 request.error().sentence.c_str());
    return 2;
  }
  render::Studio studio;
  render::Picture picture;
  const render::Outcome outcome = studio.take(world, *request, 0, 0, picture);
  if (outcome.status != "failed") problem = render::write_png(picture, picture_file);
  if (!outcome.reason.empty()) std::fprintf(stderr, "render: %s: %s\n", outcome.status.c_str(), outcome.reason.c_str());
  if (!problem.empty()) std::fprintf(stderr, "render: error io %s\n", problem.c_str());
  for (const render::Report& report : studio.stage().reports()) {
    if (report.status == "ok") continue;
    std::fprintf(stderr, "render: %s: %s: %s\n", world.object(report.object)->path.c_str(), report.status.c_str(),
                 report.reason.c_str());
  }
  return outcome.status == "failed" || !problem.empty() ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Draws the world. Without options it is a manipulator: the dialog manager starts it (start render).",
               "render");
  std::string scene, picture = "picture.png", camera, size, quality;
  auto* draw_option = app.add_option("--draw", scene, "a saved world (save FILE) to take one picture of");
  app.add_option("--out", picture, "the picture, a PNG file")->needs(draw_option)->capture_default_str();
  app.add_option("--from", camera, "the camera object")->needs(draw_option);
  app.add_option("--size", size, "WIDTHxHEIGHT in pixels")->needs(draw_option);
  app.add_option("--quality", quality, "draft, good or best")->needs(draw_option);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  if (!scene.empty()) return draw(scene, picture, camera, size, quality);

  kit::Manipulator me("render", render::declaration);
  return render::Service(me).run();
}
