#version 460
#extension GL_GOOGLE_include_directive : require

// The same triangles without an index buffer bound: each corner fetches its own index, and so knows which corner of its
// triangle it is. The fragment stage draws the edges from that.
#include "geometry.glsl"
#include "vertex.glsl"

layout(location = 4) out vec3 outCorner;

void main() {
    const uint corner = (gl_VertexIndex - gl_BaseVertex) % 3;
    outCorner = vec3(corner == 0, corner == 1, corner == 2);
    shadeVertex(Words(push.indices).at[gl_VertexIndex], push.firstDraw + gl_DrawID, gl_InstanceIndex - gl_BaseInstance);
}
