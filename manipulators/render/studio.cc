#include "manipulators/render/studio.h"

#include <algorithm>
#include <cmath>

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

void Studio::add_seen(const objdb::Database& world, const Scene& scene, const Camera& camera, Size size,
                      std::vector<std::string>& seen) const {
  for (const Seen& one : seen_by(scene, camera, size)) {
    if (!scene.drawables[one.drawable].helper) seen.push_back(scene.drawables[one.drawable].path);
  }
  // a face is a part of a surface: that the feet are in the picture does not make it seen
  const Frustum frustum(view_projection(camera, static_cast<float>(size.width) / static_cast<float>(size.height)));
  for (const Object* face : all_of(world, "face")) {
    const Object* surface = object_of(world, *face, "skin");
    if (!surface) continue;
    const Eigen::AlignedBox3f box = stage_.skins().moved_box(surface->id);
    if (!frustum.touches(box)) continue;
    // an expression that is smaller than this cannot be told
    constexpr float smallest = 6;  // [pixels]
    const float distance = std::max(std::sqrt(box.squaredExteriorDistance(camera.X_WC.translation())), camera.near);
    if (box.sizes().maxCoeff() * focal_pixels(camera, size) / distance >= smallest) seen.push_back(face->path);
  }
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
  add_seen(world, scene, camera, size, outcome.seen);
  const bool nothing = outcome.seen.empty();

  // a second picture in the lower right corner
  const Object* inset = request.view ? object_of(world, *request.view, "inset") : nullptr;
  if (inset) {
    const auto share = static_cast<float>(real_of(*request.view, "inset_share", 0.32));
    const Size small{std::max(1, static_cast<int>(static_cast<float>(size.height) * share)),
                     std::max(1, static_cast<int>(static_cast<float>(size.height) * share))};
    Scene plain = scene;
    plain.labels.clear();
    Picture second;
    const Camera second_camera = camera_of(world, *inset);
    if (canvas_->draw(plain, second_camera, small, quality, second).empty()) {
      add_seen(world, scene, second_camera, small, outcome.seen);
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
  } else if (nothing) {
    outcome.status = "empty";
    outcome.reason = scene.drawables.empty() ? "the world has nothing to be seen" : "the camera looks past everything";
  }
  last_ = wanted;
  last_picture_ = picture;
  last_outcome_ = outcome;
  return outcome;
}

}  // namespace render
