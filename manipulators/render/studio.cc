#include "manipulators/render/studio.h"

#include <algorithm>

#include "manipulators/render/cull.h"
#include "manipulators/render/look.h"

namespace render {

using objdb::Object;

Size size_of(const Request& request) {
  if (request.size) return *request.size;
  if (!request.view) return {1280, 720};
  return {static_cast<int>(integer_of(*request.view, "width", 1280)),
          static_cast<int>(integer_of(*request.view, "height", 720))};
}

Quality quality_of(const Request& request) {
  if (request.quality) return *request.quality;
  const std::string_view word = request.view ? word_of(*request.view, "quality", "good") : "good";
  return word == "draft" ? Quality::draft : word == "best" ? Quality::best : Quality::good;
}

Outcome Studio::take(const objdb::Database& world, const Request& request, double time, std::uint64_t stamp,
                     Picture& picture) {
  const Object* named = request.camera ? request.camera : chosen_camera(world, request.view);
  const Size size = size_of(request);
  const Quality quality = quality_of(request);
  const Last wanted{stamp, request.view ? request.view->id : 0, named ? named->id : 0, size, quality, time};
  if (stamp != 0 && wanted == last_ && last_picture_.size() == size) {
    picture = last_picture_;
    return last_outcome_;
  }

  Outcome outcome;
  auto failed = [&](std::string reason) {
    outcome.status = "failed";
    outcome.reason = std::move(reason);
    return outcome;
  };
  if (!canvas_) {
    std::string problem;
    canvas_ = Canvas::make(problem);
    if (!canvas_) return failed(problem);
  }
  const Scene scene = stage_.compose(world, request.view, time);
  const float aspect = static_cast<float>(size.width) / static_cast<float>(size.height);
  const Camera camera = named ? camera_of(world, *named) : camera_for(scene, aspect);
  if (std::string problem = canvas_->draw(scene, camera, size, quality, picture); !problem.empty()) {
    return failed(problem);
  }
  ++drawn_;
  outcome.cost = canvas_->cost();
  for (const Seen& one : seen_by(scene, camera, size)) {
    if (!scene.drawables[one.drawable].helper) outcome.seen.push_back(scene.drawables[one.drawable].path);
  }

  // a second picture in the lower right corner
  const Object* inset = request.view ? object_of(world, *request.view, "inset") : nullptr;
  if (inset) {
    const auto share = static_cast<float>(real_of(*request.view, "inset_share", 0.32));
    const Size small{std::max(1, static_cast<int>(static_cast<float>(size.height) * share)),
                     std::max(1, static_cast<int>(static_cast<float>(size.height) * share))};
    Scene plain = scene;
    plain.labels.clear();
    Picture second;
    if (canvas_->draw(plain, camera_of(world, *inset), small, quality, second).empty()) {
      const int margin = std::max(1, size.height / 45);
      const int x = size.width - small.width - margin;
      const int y = size.height - small.height - margin;
      paste(second, picture, x, y);
      const int edge = std::max(1, size.height / 360);
      outline(picture, x - edge, y - edge, {small.width + 2 * edge, small.height + 2 * edge}, edge,
              {246, 246, 242, 255});
      outcome.cost.cpu_seconds += canvas_->cost().cpu_seconds;
      outcome.cost.triangles += canvas_->cost().triangles;
    }
  }

  if (std::string solid = solid_around(scene, camera); !solid.empty()) {
    outcome.status = "inside";
    outcome.reason = "the camera stands inside " + solid;
  } else if (outcome.seen.empty()) {
    outcome.status = "empty";
    outcome.reason = scene.drawables.empty() ? "the world has nothing to be seen" : "the camera looks past everything";
  }
  last_ = wanted;
  last_picture_ = picture;
  last_outcome_ = outcome;
  return outcome;
}

}  // namespace render
