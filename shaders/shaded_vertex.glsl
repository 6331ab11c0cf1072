// What a vertex hands to the fragment stages that shade.
#include "vertex.glsl"

layout(location = 0) out vec3 outPosition; // world
layout(location = 1) out vec3 outNormal;   // world, zero where the asset has none
layout(location = 2) out vec4 outColor;    // linear
layout(location = 3) flat out uint outDraw;
layout(location = 5) flat out vec2 outMarks; // error in world units; 1 where highlighted

void shadeVertex(uint row, uint draw, uint instanceInDraw) {
    const uint id = instanceOf(draw, instanceInDraw);
    const Vertex v = placeVertex(row, id);
    outPosition = v.position;
    outNormal = v.normal;
    outColor = v.color;
    outDraw = draw;
    const DrawRecord record = Draws(push.draws).at[draw];
    ViewRecord view = Views(push.view).at;
    const bool highlighted = id == view.highlightInstance && record.part == view.highlightPart;
    outMarks = vec2(record.error * Instances(push.instances).at[id].maxScale, highlighted ? 1 : 0);
}
