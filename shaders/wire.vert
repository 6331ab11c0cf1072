#version 460
#extension GL_GOOGLE_include_directive : require

// The same triangles without an index buffer bound: each corner fetches its own index, and so knows which corner of its
// triangle it is. The fragment stage draws the edges from that.
#include "geometry.glsl"
#include "shaded_vertex.glsl"

layout(location = 4) out vec3 outCorner;

uint fetchIndex(uint indexBytes, uint i) {
    if (indexBytes == 4) return Words(push.indices).at[i];
    const uint pair = Words(push.indices).at[i / 2];
    return i % 2 == 0 ? pair & 0xffff : pair >> 16;
}

void main() {
    const uint corner = (gl_VertexIndex - gl_BaseVertex) % 3;
    outCorner = vec3(corner == 0, corner == 1, corner == 2);
    const uint draw = push.firstDraw + gl_DrawID;
    const DrawRecord record = Draws(push.draws).at[draw];
    shadeVertex(fetchIndex(record.indexBytes, gl_VertexIndex) + record.vertexOffset, draw,
                gl_InstanceIndex - gl_BaseInstance);
}
