// Vertex pulling: records and streams by device address, and what a vertex hands to the fragment stage.
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_GOOGLE_include_directive : require

#include "shared.h"

layout(buffer_reference, std430, buffer_reference_align = 16) readonly buffer Views { ViewRecord at; };
layout(buffer_reference, std430, buffer_reference_align = 16) readonly buffer Instances { InstanceRecord at[]; };
layout(buffer_reference, std430, buffer_reference_align = 16) readonly buffer Draws { DrawRecord at[]; };
layout(buffer_reference, std430, buffer_reference_align = 16) readonly buffer Materials { MaterialRecord at[]; };
layout(buffer_reference, std430, buffer_reference_align = 4) readonly buffer Words { uint at[]; };
layout(buffer_reference, std430, buffer_reference_align = 4) readonly buffer Floats { float at[]; };
layout(buffer_reference, std430, buffer_reference_align = 16) readonly buffer Vectors { vec4 at[]; };

layout(push_constant) uniform Push { PushConstants push; };

const uint kFormatF32x4 = 6; // xgc::format::StreamFormat

bool isNull(uvec2 address) {
    return (address.x | address.y) == 0;
}
