#version 460
#extension GL_GOOGLE_include_directive : require

// A level of the depth pyramid: the farthest (least, depth being reversed) of up to four texels of the finer one. Step:
// the level.
#include "gpu.glsl"

layout(local_size_x = 64) in;

void main() {
    const DepthLevel fine = depthLevel(push.step - 1), coarse = depthLevel(push.step);
    const uint i = groupNumber() * 64 + gl_LocalInvocationIndex;
    if (i >= coarse.size.x * coarse.size.y) return;
    const uvec2 at = 2 * uvec2(i % coarse.size.x, i / coarse.size.x), last = min(at + 1, fine.size - 1);
    Floats depth = Floats(frame.depth);
    const uint row = fine.first + at.y * fine.size.x, nextRow = fine.first + last.y * fine.size.x;
    const float farthest = min(min(depth.at[row + at.x], depth.at[row + last.x]),
                               min(depth.at[nextRow + at.x], depth.at[nextRow + last.x]));
    WordsOut(frame.depth).at[coarse.first + i] = floatBitsToUint(farthest);
}
