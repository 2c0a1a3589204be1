#pragma once

#include "manipulators/render/scene.h"
#include "objdb/database.h"

namespace render {

class Trails;

/// Adds what the fields of a `view` object ask for: bones, joint limits, gaze rays, muscles, finite elements, trails,
/// and text. Everything added is marked as a helper.
void add_views(const objdb::Database& world, const objdb::Object& view, const Trails& trails, double time,
               Scene& scene);

/// Bones: a spindle from each joint to the next, a rod along each `bone`, and every joint's axis.
void add_bones(const objdb::Database& world, Scene& scene);
/// Joint limits: for each joint the sector between `lower` and `upper` about its axis, and a needle at `angle`.
/// Objects with a field `swing_limit` (one angle, or several around the axis) get a cone about their rest direction.
void add_limits(const objdb::Database& world, Scene& scene);
/// Lines of sight of all eyes: to the target's distance when there is one, 3 m otherwise.
void add_gaze_rays(const objdb::Database& world, Scene& scene);
/// Objects with fields `origin` and `insertion`: tubes, blue at rest, red at full activation.
void add_muscles(const objdb::Database& world, Scene& scene);
/// The ways of nodes, fading with age.
void add_trails(const objdb::Database& world, const objdb::Object& view, const Trails& trails, double time,
                Scene& scene);
/// Lines of text: every value that fits a pattern as `path.field value`; `time`; anything else as it stands.
void add_overlay(const objdb::Database& world, const objdb::Object& view, double time, Scene& scene);

}  // namespace render
