#pragma once

#include <memory>
#include <string>
#include <vector>

#include "manipulators/render/canvas.h"
#include "manipulators/render/request.h"
#include "manipulators/render/stage.h"

namespace render {

/// What a picture was: the words of view.status and view.reason, and what it took.
struct Outcome {
  std::string status = "ok";
  std::string reason;
  Cost cost;
  std::vector<std::string> seen;  ///< paths of what was in the picture
};

/// Takes pictures of a world.
class Studio {
 public:
  /// A picture as `request` and its view ask for. `outcome.status` is `failed` when there is none.
  /// An unchanged world (same `stamp`, not 0) asked for in the same way is not drawn again.
  Outcome take(const objdb::Database& world, const Request& request, double time, std::uint64_t stamp,
               Picture& picture);

  Stage& stage() { return stage_; }
  /// How many pictures were really drawn.
  long long drawn() const { return drawn_; }

 private:
  // what the last picture was of
  struct Last {
    std::uint64_t stamp = 0;
    objdb::ObjectId view = 0, camera = 0;
    Size size;
    Quality quality = Quality::good;
    double time = 0;
    bool operator==(const Last&) const = default;
  };

  void add_seen(const objdb::Database& world, const Scene& scene, const Camera& camera, Size size,
                std::vector<std::string>& seen) const;

  Stage stage_;
  std::unique_ptr<Canvas> canvas_;
  Last last_;
  Picture last_picture_;
  Outcome last_outcome_;
  long long drawn_ = 0;
};

/// Size and quality: what the request says, else its view, else 1280x720 good.
Size size_of(const Request& request);
Quality quality_of(const Request& request);

}  // namespace render
