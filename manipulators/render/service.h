#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "manipulators/kit/manipulator.h"
#include "manipulators/render/gltf.h"
#include "manipulators/render/movie.h"
#include "manipulators/render/speaker.h"
#include "manipulators/render/studio.h"
#include "manipulators/render/window.h"

namespace render {

/// The renderer as the dialog manager knows it: answers the verbs, films the ticks, keeps view.* and mesh.* told.
class Service {
 public:
  explicit Service(kit::Manipulator& me);
  int run();

 private:
  using Reply = objdb::Result<std::string>;

  void tick(const kit::Tick& tick);
  Reply snapshot(objdb::Words words);
  Reply sheet(objdb::Words words);
  Reply movie(objdb::Words words);
  /// Adds the world as it is to the film, so many times.
  void film(int frames);
  Reply export_scene(objdb::Words words);
  Reply animate(objdb::Words words);
  Reply window(objdb::Words words);
  Reply bind(objdb::Words words);
  Reply unbind(objdb::Words words);
  /// Gives the window the world as it is, and the world the window's state.
  void show();

  /// Tells how far marks have gone from rest.
  void follow_marks();

  Outcome take(const Request& request, double time, Picture& picture);
  void tell(const Request& request, const Outcome& outcome);
  std::uint64_t stamp();

  kit::Manipulator& me_;
  Studio studio_;
  std::unique_ptr<Movie> movie_;
  // the film's request, with its objects by path because they may be deleted while it runs
  Request film_;
  std::string film_camera_, film_view_;
  std::unique_ptr<Gltf> animation_;
  std::string animation_file_;
  std::unique_ptr<Speaker> speaker_;
  std::unique_ptr<Window> window_;
  std::string window_view_;
  std::map<std::string, std::string> bindings_;
  double now_ = 0;
  objdb::Database::FeedId feed_;
  std::uint64_t stamp_ = 1;
};

}  // namespace render
