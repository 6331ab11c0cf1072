#version 460
#extension GL_GOOGLE_include_directive : require

#include "geometry.glsl"
#include "shaded_vertex.glsl"

void main() {
    shadeVertex(gl_VertexIndex, push.firstDraw + gl_DrawID, gl_InstanceIndex - gl_BaseInstance);
}
