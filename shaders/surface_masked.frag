#version 460
#extension GL_GOOGLE_include_directive : require

#include "geometry.glsl"
#include "alpha.glsl"
#include "lighting.glsl"

layout(location = 0) out vec4 outTarget;

void main() {
    const ViewRecord view = Views(push.view).at;
    const DrawRecord draw = Draws(push.draws).at[inDraw];
    discardBelowCutoff(draw.material, inColor.a);
    outTarget = vec4(light(highlight(surfaceOf(draw, view), view), view), 1);
}
