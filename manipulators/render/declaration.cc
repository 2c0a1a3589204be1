#include "manipulators/render/declaration.h"

namespace render {

const std::string_view declaration = R"~(
field mesh.status word = none of none ok stand_in failed "stand_in: the body's file is missing and capsules are drawn"
field mesh.reason text "one sentence: which file, what is wrong"
field mesh.smooth bool = true "normals from the surface, so that facets do not show"

type material extends node "what a part of a mesh looks like; below the mesh, under the part's name"
field material.color vec3 = 0.8 0.8 0.8 in 0 1 "red green blue, sRGB"
field material.opacity real = 1 in 0 1
field material.shininess real = 0.2 in 0 1 "0 is chalk, 1 is polished"
field material.finish word = plain of plain skin cloth "how it answers light"

type skin extends mesh "a surface that follows bones"
field skin.skeleton ref:node "its bones are the objects of type bone below this node"
field skin.blend word = dual_quaternion of dual_quaternion linear "how turns of neighbouring bones are mixed"

type bone extends node "a rigid segment that moves the skin around it; a child of the joint it follows"
field bone.from vec3 m "its axis, in its own frame; from is nearer to the trunk"
field bone.to vec3 m "the other end of its axis"
field bone.radius real m = 5cm in 0 1 "about how far the skin is from the axis"
field bone.bind_position vec3 m "its frame in the skin's frame when the skin was bound"
field bone.bind_orientation quat "rotation of that frame"
field bone.twist_from ref:bone "whose rotation about the axis it takes over in part"
field bone.twist real = 1 in 0 1 "share of its own rotation about its axis"

type garment extends node "a region of a skin with its own colour and thickness"
field garment.skin ref:skin "what it clothes"
field garment.bones ref:bone[] "where these hold at least half of the weight; none: everywhere"
field garment.planes real[] "nx ny nz d of each plane; inside is n.p + d >= 0, in the skin's frame at bind time"
field garment.lines real[] "x y z r of balls along a line; radius 0 ends a line; inside is near the line"
field garment.thickness real m = 0 in 0 0.1 "of the cloth"
field garment.flare real[4] = 0 0 0 0 "cloth that hangs wide: thicker by max(0, n.p + d)"
field garment.smoothing int = 0 in 0 200 "passes that even out what is under the cloth"
field garment.layer int = 0 "higher layers cover lower ones; equal layers in order of path"
field garment.color vec3 = 0.8 0.8 0.8 in 0 1 "red green blue, sRGB"
field garment.gloss real = 0.1 in 0 1 "0 is wool, 1 is patent leather"

type mark "a vertex of a surface, watched"
field mark.surface ref:mesh "the skin or mesh"
field mark.vertex int = 0 in 0 1e9 "its number in the file"
field mark.travel real m "how far faces have moved it from rest"

type eyeball extends shape "an eye as it is seen; it looks along its +Z"
field eyeball.radius real m = 12mm in 1mm 1 "of the ball"
field eyeball.iris_color vec3 = 0.27 0.42 0.55 in 0 1 "red green blue, sRGB"
field eyeball.iris real m = 5.9mm in 0 1 "radius of the iris"
field eyeball.pupil real m = 1.8mm in 0 1 "radius of the pupil"
field eyeball.lids bool = false "whether lids of its own are drawn; they stay with the eye's parent"
field eyeball.upper_lid real rad = 0.45 in -1.6 1.6 "elevation of the upper lid's edge"
field eyeball.lower_lid real rad = -0.5 in -1.6 1.6 "elevation of the lower lid's edge"

type view "what pictures show besides the world, and how"
field view.camera ref:camera "seen through which; none: the first camera, or one in front of everything"
field view.width int = 1280 in 1 16384 "pixels"
field view.height int = 720 in 1 16384 "pixels"
field view.quality word = good of draft good best "draft: no antialiasing; best: four times the work, for stills"
field view.ground word = studio of none grid studio sea "what is below everything"
field view.ground_height real m = 0 "where the ground is"
field view.zenith vec3 = 0.36 0.55 0.78 in 0 1 "sky overhead, sRGB"
field view.horizon vec3 = 0.80 0.86 0.90 in 0 1 "sky at the horizon, sRGB"
field view.bones bool = false "bones, and the axis of every joint"
field view.limits bool = false "how far each joint may turn, and where it stands"
field view.gaze_rays bool = false "where eyes look"
field view.muscles bool = false "muscles as tubes coloured by activation"
field view.elements word = none of none wireframe displacement strain error "finite elements cut open, coloured by a result"
field view.cut real[4] = 1 0 0 0 "plane n.p + d = 0 in the figure's frame; elements with n.p + d > 0 are shown"
field view.trails ref:node[] "nodes whose way is drawn"
field view.trail_time real s = 2 in 0.01 600 "how far back"
field view.overlay text[] "patterns of fields whose values are written on the picture, or other words as they are"
field view.inset ref:camera "a second picture in the corner"
field view.inset_share real = 0.32 in 0.05 0.9 "of the height"
field view.skin_opacity real = 1 in 0 1 "of skins, to see what lies below"
field view.status word = ok of ok empty inside failed "empty: nothing in sight; inside: the camera is within a solid"
field view.reason text "one sentence"
field view.window word = off of off open closed lost measured "closed: by the person at it; lost: its X server is gone"
field view.drawn int measured "drawables in the last picture"
field view.culled int measured "drawables left out: out of sight or too small"
field view.triangles int measured "in the last picture"
field view.cpu_time real s measured "processor time of the last picture"

field view.seen ref[] measured "figures, heads, faces, eyes and skins in the last picture and its inset: the others could rest"

verb snapshot "FILE.png [from CAMERA] [size WxH] [quality WORD] [with VIEW]" "a picture of the world as it is"
verb sheet "FILE.png PICTURE.png... [columns N] [size WxH]" "pictures side by side, each with its name"
verb movie "FILE.mp4|FOLDER|off [from CAMERA] [size WxH] [rate HZ] [quality WORD] [with VIEW]" "films every tick from now on; off ends"
verb export "FILE.glb" "the scene as it stands, as glTF"
verb animate "FILE.glb|off" "records the movement from now on as glTF animation; off writes it"
verb window "on|off|refresh [size WxH] [with VIEW]" "the pictures on the screen"
verb bind "EVENT COMMAND" "what a key or the mouse says: Key-space, Shift-Key-r, Button1, Button1-drag, Wheel-up"
verb unbind "EVENT" "takes a binding back"

reads node
reads muscle
reads face
writes mesh.status mesh.reason
writes view.status view.reason
writes mark.travel
timeout 60s
)~";

}  // namespace render
