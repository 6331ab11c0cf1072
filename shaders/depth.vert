#version 460
#extension GL_GOOGLE_include_directive : require

#include "geometry.glsl"
#include "vertex.glsl"

void main() {
    placeVertex(gl_VertexIndex, instanceOf(push.firstDraw + gl_DrawID, gl_InstanceIndex - gl_BaseInstance));
}
