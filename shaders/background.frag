#version 460

layout(location = 0) in vec2 inPlace;
layout(location = 0) out vec4 outTarget;

// Light grey, a little darker below and towards the corners.
void main() {
    const vec2 fromCenter = inPlace - vec2(0.5, 0.42);
    const vec3 top = vec3(0.87, 0.885, 0.905), bottom = vec3(0.62, 0.63, 0.645);
    const vec3 grey = mix(top, bottom, smoothstep(0.05, 1.05, inPlace.y));
    const float vignette = 1.0 - 0.22 * dot(fromCenter, fromCenter);
    // Half a step of noise hides the banding of eight bits.
    const float noise = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715)))) - 0.5;
    outTarget = vec4(grey * vignette + noise / 255.0, 1);
}
