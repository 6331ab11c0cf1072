#version 460
#extension GL_GOOGLE_include_directive : require

#include "geometry.glsl"
#include "lighting.glsl"

layout(location = 4) in vec3 inCorner;
layout(location = 0) out vec4 outTarget;

const vec3 kInk = vec3(0.020, 0.024, 0.032);

// Strength of the nearest edge's line. Triangles of few pixels get fainter lines, so that dense meshes turn grey, not
// black.
float edgeInk(float linePixels) {
    const vec3 slope = sqrt(dFdx(inCorner) * dFdx(inCorner) + dFdy(inCorner) * dFdy(inCorner));
    const vec3 pixels = inCorner / max(slope, vec3(1e-6));
    const float nearest = min(pixels.x, min(pixels.y, pixels.z));
    // 1 / slope is the triangle's height over an edge, in pixels.
    const float height = 1.0 / max(slope.x, max(slope.y, slope.z));
    const float halfWidth = 0.5 * linePixels;
    const float line = 1.0 - smoothstep(halfWidth - 0.4, halfWidth + 0.5, nearest);
    return line * clamp(height / (5.0 * linePixels), 0.2, 0.9);
}

void main() {
    const ViewRecord view = Views(push.view).at;
    const DrawRecord draw = Draws(push.draws).at[inDraw];
    outTarget = vec4(mix(light(highlight(surfaceOf(draw, view), view), view), kInk, edgeInk(view.linePixels)), 1);
}
