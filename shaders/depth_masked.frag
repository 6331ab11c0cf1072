#version 460
#extension GL_GOOGLE_include_directive : require

#include "geometry.glsl"
#include "alpha.glsl"

layout(location = 0) in float inAlpha;
layout(location = 1) flat in uint inDraw;

void main() {
    discardBelowCutoff(Draws(push.draws).at[inDraw].material, inAlpha);
}
