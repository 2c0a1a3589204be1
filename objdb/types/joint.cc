#include <string_view>

namespace objdb::types {

extern const std::string_view joint;
const std::string_view joint = R"~(
type joint extends node "a turning joint: position, orientation, then Rot(z, theta0 + angle) Trans(0, 0, d) Trans(a, 0, 0) Rot(x, alpha)"
field joint.dh real[4] rad,m,m,rad "Denavit-Hartenberg (standard form, Paul 1981): theta0 d a alpha"
field joint.angle real rad "turn about z beyond theta0"
field joint.lower real rad = -3.141592653589793 "least angle"
field joint.upper real rad = 3.141592653589793 "greatest angle"
field joint.rest real rad "angle of the posture at rest"
)~";

}  // namespace objdb::types
