// The alpha test: a pipeline of its own has it, so that opaque materials keep their early depth test.
void discardBelowCutoff(uint material, float vertexAlpha) {
    const MaterialRecord m = Materials(push.materials).at[material];
    if (m.baseColor.a * vertexAlpha < m.alphaCutoff) discard;
}
