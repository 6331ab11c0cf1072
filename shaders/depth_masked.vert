#version 460
#extension GL_GOOGLE_include_directive : require

#include "geometry.glsl"
#include "vertex.glsl"

layout(location = 0) out float outAlpha;
layout(location = 1) flat out uint outDraw;

void main() {
    outDraw = push.firstDraw + gl_DrawID;
    outAlpha = placeVertex(gl_VertexIndex, instanceOf(outDraw, gl_InstanceIndex - gl_BaseInstance)).color.a;
}
