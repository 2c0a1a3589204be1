#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "manipulators/face_fem/actor.h"
#include "manipulators/face_fem/performance.h"
#include "manipulators/kit/manipulator.h"

namespace face {

/// The faces of a world: one `face` object each, which moves vertices of the skin or mesh that it names.
class Faces {
 public:
  Faces();
  int run() { return me_.run(); }

 private:
  using Object = objdb::Object;
  template <class T>
  using Answer = objdb::Result<T>;

  // what is remembered of one face
  struct Live {
    std::string made_of;  // of what the actor was made, or what it could not be made of
    std::unique_ptr<Actor> actor;
    std::unique_ptr<Driver> driver;
    std::string fault;           // why there is no actor
    std::string muscle_fault;    // what is wrong with an object of type muscle
    std::vector<Muscle> placed;  // muscles as they were built; the actor's own may have been dragged
    Performance play;
    bool recalled = false;
    // what the last frame was made of, so that a face at rest costs nothing
    Drive drive;
    FaceMethod method = FaceMethod::contact;
    bool shown = false;
  };

  Answer<std::string> express(objdb::Words words);
  Answer<std::string> relax(objdb::Words words);
  Answer<std::string> speak(objdb::Words words);
  Answer<std::string> show_muscles(objdb::Words words);
  Answer<const Object*> face_of(const objdb::Word& word) const;
  Answer<Parts> parts_named(std::string_view word, std::string* channel) const;
  Live& live(const Object& object);

  void tick(const kit::Tick& now);
  void move(const Object& object, Live& face, const kit::Tick& now);
  bool make(const Object& object, Live& face);
  void place_muscles(const Object& object, Live& face, std::vector<double>* own_levels);
  Eyes eyes_of(const Object& object) const;
  const Object* gaze_of(const Object& object) const;
  FaceMethod method_of(const Object& object, const Live& face, const Drive& drive) const;
  void show(const Object& object, Live& face, const Drive& drive);
  void show_levels(const Object& object, const Levels& levels);
  void report(const Object& object, const Live& face, const Frame& frame, FaceMethod method);
  void show_tissues(const Object& object, const Live& face, const Drive& drive);
  void remember();

  kit::Manipulator me_;
  std::map<objdb::ObjectId, Live> faces_;
};

}  // namespace face
