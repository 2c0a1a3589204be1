#pragma once

#include <string>

/// The GLSL 3.30 sources. Each function returns a whole shader. The uniform block `Frame` is the same in all of them
/// and is mirrored by `FrameBlock` in canvas.cc.
///
/// The software rasterizer runs fragment shaders on blocks of 4 x 4 pixels, so that each of many small triangles pays
/// for sixteen pixels. That is why surfaces are first drawn with almost no shader and lit afterwards, once a pixel:
/// on 40 000 triangles this is several times faster than lighting them as they are drawn. It also runs both sides of
/// every branch, which is why each kind of surface has a program of its own.
namespace render::shaders {

std::string surface_vertex();    ///< all drawables
std::string surface_fragment();  ///< colour, normal, depth and finish into two images, no light yet
std::string eye_fragment();      ///< the same for Finish::eye
std::string screen_vertex();     ///< one triangle over the whole picture, no vertices needed
std::string light_fragment();    ///< lights what the surface pass left behind, once a pixel
std::string ground_vertex();
std::string grid_fragment();    ///< Ground::grid, and Ground::studio under near lights
std::string studio_vertex();    ///< Ground::studio: light and distance at the vertices
std::string studio_fragment();  ///< with shadows
std::string shade_fragment();   ///< what the vertices say, without shadows: the ground far from everything, the sky
std::string sea_fragment();     ///< Ground::sea
std::string sky_vertex();
std::string clear_fragment();  ///< surfaces that are seen through, lit as they are drawn
std::string flat_fragment();   ///< Finish::unlit
std::string depth_vertex();    ///< shadow map
std::string depth_fragment();
std::string occlusion_fragment();  ///< how much of the sky a pixel sees, from its surroundings, at half size
std::string blur_fragment();       ///< takes the grain out of it

}  // namespace render::shaders
