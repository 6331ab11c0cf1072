#include "models/makers.h"

#include "models/surface_net.h"
#include "models/trig.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

// A young dragon that sits upright, one unit tall, facing +z. It is a list of blobs in the order in which they melt
// together: trunk, tail, legs, head, arms, then what stands out sharply (eyes, horns, claws, spines).

namespace xgc::bake::models {
namespace {

enum CreatureMaterial : uint32_t { kHide, kHorn, kEye };

constexpr glm::vec3 kGreen(0.16f, 0.42f, 0.30f);
constexpr glm::vec3 kDeepGreen(0.07f, 0.26f, 0.22f);
constexpr glm::vec3 kCream(0.86f, 0.72f, 0.44f);
constexpr glm::vec3 kRose(0.72f, 0.34f, 0.26f);
constexpr glm::vec3 kIvory(0.82f, 0.74f, 0.58f);

const Skin kBack{kGreen, kHide};
const Skin kDark{kDeepGreen, kHide};
const Skin kMouth{glm::vec3(0.10f, 0.06f, 0.06f), kHide};
const Skin kGleam{glm::vec3(0.95f), kEye};
const Skin kBelly{kCream, kHide};
const Skin kBlush{kRose, kHide};
const Skin kHornSkin{kIvory, kHorn};
const Skin kEyeSkin{glm::vec3(0.02f), kEye};

/// A point and a radius of a limb.
struct Joint {
    glm::vec3 at;
    float radius;
};

glm::vec3 mirror(glm::vec3 p) {
    return {-p.x, p.y, p.z};
}

void addLimb(Body& body, std::span<const Joint> joints, float blend, Skin skin) {
    for (size_t i = 0; i + 1 < joints.size(); ++i) {
        body.add(roundCone(joints[i].at, joints[i].radius, joints[i + 1].at, joints[i + 1].radius, blend, skin));
    }
}

/// Both sides: the joints are those of the creature's left (+x).
void addLimbs(Body& body, std::span<const Joint> joints, float blend, Skin skin) {
    addLimb(body, joints, blend, skin);
    std::vector<Joint> other(joints.begin(), joints.end());
    for (Joint& joint : other) joint.at = mirror(joint.at);
    addLimb(body, other, blend, skin);
}

void carveLimbs(Body& body, std::span<const Joint> joints, float blend, Skin skin) {
    const size_t first = body.blobs.size();
    addLimbs(body, joints, blend, skin);
    for (size_t i = first; i < body.blobs.size(); ++i) body.blobs[i].carve = true;
}

void addPair(Body& body, glm::vec3 center, glm::vec3 radii, double turn, float blend, Skin skin) {
    body.add(ellipsoid(center, radii, rotationZ(turn), blend, skin));
    body.add(ellipsoid(mirror(center), radii, rotationZ(-turn), blend, skin));
}

/// The path of spine and tail, from neck to tip.
constexpr std::array<Joint, 9> kTail = {{{{0.00f, 0.20f, -0.10f}, 0.130f},
                                         {{0.00f, 0.115f, -0.23f}, 0.098f},
                                         {{0.07f, 0.078f, -0.35f}, 0.076f},
                                         {{0.20f, 0.062f, -0.41f}, 0.060f},
                                         {{0.34f, 0.052f, -0.38f}, 0.047f},
                                         {{0.43f, 0.050f, -0.27f}, 0.037f},
                                         {{0.455f, 0.060f, -0.15f}, 0.029f},
                                         {{0.43f, 0.095f, -0.05f}, 0.022f},
                                         {{0.40f, 0.150f, 0.00f}, 0.016f}}};

/// A Catmull-Rom curve through joints, four pieces between two.
std::vector<Joint> smoothPath(std::span<const Joint> joints) {
    const auto at = [&](size_t i, int shift) {
        const auto last = int64_t(joints.size()) - 1;
        const Joint& j = joints[size_t(std::clamp(int64_t(i) + shift, int64_t(0), last))];
        return glm::vec4(j.at, j.radius);
    };
    std::vector<Joint> out;
    for (size_t i = 0; i + 1 < joints.size(); ++i) {
        const glm::vec4 a = at(i, -1), b = at(i, 0), c = at(i, 1), d = at(i, 2);
        for (int k = 0; k < 4; ++k) {
            const float t = 0.25f * float(k);
            const glm::vec4 p =
                b + 0.5f * t * (c - a + t * (2.0f * a - 5.0f * b + 4.0f * c - d + t * (3.0f * (b - c) + d - a)));
            out.push_back({glm::vec3(p), p.w});
        }
    }
    out.push_back(joints.back());
    return out;
}

void addTrunk(Body& body) {
    body.add(roundCone({0, 0.235f, -0.03f}, 0.180f, {0, 0.47f, -0.02f}, 0.112f, 0.05f, kBack));
    body.add(ellipsoid({0, 0.27f, 0.045f}, {0.150f, 0.175f, 0.130f}, glm::mat3(1), 0.05f, kBelly));
    body.add(ellipsoid({0, 0.45f, 0.035f}, {0.085f, 0.120f, 0.080f}, glm::mat3(1), 0.05f, kBelly));
    addLimb(body, smoothPath(kTail), 0.012f, kBack);
    // Spade of the tail.
    body.add(ellipsoid({0.385f, 0.195f, 0.012f}, {0.050f, 0.058f, 0.017f}, rotationZ(0.06) * rotationY(0.08), 0.02f,
                       kBlush));
}

void addLegs(Body& body) {
    const Joint thigh[] = {{{0.115f, 0.175f, 0.00f}, 0.115f}, {{0.205f, 0.150f, 0.115f}, 0.082f}};
    addLimbs(body, thigh, 0.05f, kBack);
    const Joint shin[] = {{{0.205f, 0.150f, 0.115f}, 0.074f}, {{0.200f, 0.062f, 0.10f}, 0.056f}};
    addLimbs(body, shin, 0.03f, kBack);
    const Joint foot[] = {{{0.200f, 0.050f, 0.10f}, 0.050f}, {{0.222f, 0.040f, 0.20f}, 0.042f}};
    addLimbs(body, foot, 0.03f, kBack);
    for (int toe = -1; toe <= 1; ++toe) {
        const auto side = float(toe);
        const glm::vec3 root(0.222f + 0.026f * side, 0.036f, 0.205f - 0.006f * side * side);
        const glm::vec3 tip = root + glm::vec3(0.017f * side + 0.008f, -0.006f, 0.062f - 0.012f * side * side);
        const Joint joints[] = {{root, 0.028f}, {tip, 0.0235f}};
        addLimbs(body, joints, 0.012f, kBack);
        const glm::vec3 out = tip + glm::vec3(0.005f * side, 0.001f, 0.016f);
        const Joint claw[] = {{out, 0.0135f}, {out + glm::vec3(0.004f * side, -0.012f, 0.026f), 0.003f}};
        addLimbs(body, claw, 0.003f, kHornSkin);
    }
}

void addHand(Body& body, glm::vec3 wrist, float side) {
    const auto at = [&](float x, float y, float z) { return wrist + glm::vec3(side * x, y, z); };
    const glm::vec3 palm = at(0.004f, -0.004f, 0.036f);
    body.add(ellipsoid(palm, {0.037f, 0.022f, 0.040f}, rotationZ(-0.07 * double(side)), 0.02f, kBack));
    constexpr float spread[3] = {-0.023f, 0.002f, 0.026f};
    constexpr float reach[3] = {0.036f, 0.043f, 0.036f};
    for (int i = 0; i < 3; ++i) {
        const Joint joints[] = {{at(0.004f + spread[i], -0.004f, 0.060f), 0.0165f},
                                {at(0.006f + 1.45f * spread[i], -0.002f, 0.062f + reach[i]), 0.0140f},
                                {at(0.006f + 1.65f * spread[i], -0.020f, 0.062f + 1.55f * reach[i]), 0.0115f}};
        addLimb(body, joints, 0.007f, kBack);
        const glm::vec3 tip = joints[2].at;
        body.add(roundCone(tip + glm::vec3(0, -0.004f, 0.005f), 0.008f, tip + glm::vec3(0, -0.020f, 0.014f), 0.002f,
                           0.002f, kHornSkin));
    }
    const Joint thumb[] = {{at(-0.026f, 0.004f, 0.030f), 0.0155f},
                           {at(-0.050f, 0.014f, 0.050f), 0.0130f},
                           {at(-0.058f, 0.012f, 0.070f), 0.0110f}};
    addLimb(body, thumb, 0.008f, kBack);
}

void addArms(Body& body) {
    const Joint left[] = {
        {{0.085f, 0.475f, 0.00f}, 0.062f}, {{0.190f, 0.395f, 0.02f}, 0.046f}, {{0.225f, 0.395f, 0.13f}, 0.034f}};
    addLimb(body, left, 0.03f, kBack);
    addHand(body, left[2].at, 1);
    // The right hand is raised in greeting.
    const Joint right[] = {
        {{-0.085f, 0.475f, 0.00f}, 0.062f}, {{-0.200f, 0.405f, 0.03f}, 0.046f}, {{-0.245f, 0.440f, 0.13f}, 0.034f}};
    addLimb(body, right, 0.03f, kBack);
    addHand(body, right[2].at, -1);
}

void addHead(Body& body) {
    const Joint neck[] = {{{0, 0.50f, -0.015f}, 0.092f}, {{0, 0.66f, 0.00f}, 0.085f}};
    addLimb(body, neck, 0.05f, kBack);
    body.add(ellipsoid({0, 0.775f, 0.015f}, {0.178f, 0.150f, 0.160f}, glm::mat3(1), 0.05f, kBack));
    addPair(body, {0.092f, 0.715f, 0.085f}, {0.075f, 0.065f, 0.075f}, 0, 0.05f, kBack);
    body.add(ellipsoid({0, 0.712f, 0.150f}, {0.098f, 0.062f, 0.105f}, glm::mat3(1), 0.05f, kBack));
    body.add(ellipsoid({0, 0.680f, 0.130f}, {0.088f, 0.042f, 0.098f}, glm::mat3(1), 0.03f, kBelly));
    // Brows over the eyes, then nostrils on small mounds.
    const Joint brow[] = {{{0.060f, 0.868f, 0.120f}, 0.024f}, {{0.135f, 0.852f, 0.090f}, 0.022f}};
    addLimbs(body, brow, 0.035f, kBack);
    const Joint smile[] = {{{0.000f, 0.694f, 0.258f}, 0.0065f},
                           {{0.040f, 0.692f, 0.249f}, 0.0065f},
                           {{0.074f, 0.697f, 0.222f}, 0.0060f},
                           {{0.098f, 0.712f, 0.186f}, 0.0050f},
                           {{0.107f, 0.728f, 0.168f}, 0.0030f}};
    carveLimbs(body, smile, 0.006f, kMouth);
    addPair(body, {0.036f, 0.752f, 0.230f}, {0.021f, 0.017f, 0.021f}, 0, 0.02f, kBack);
    Blob nostril = ellipsoid({0.039f, 0.757f, 0.250f}, {0.0095f, 0.0065f, 0.012f}, rotationZ(0.08), 0.006f, kDark);
    nostril.carve = true;
    body.add(nostril);
    nostril.origin.x = -nostril.origin.x;
    nostril.toFrame = ellipsoid({}, {0.0095f, 0.0065f, 0.012f}, rotationZ(-0.08), 0, kDark).toFrame;
    body.add(nostril);
}

void addEars(Body& body) {
    for (const float side : {1.0f, -1.0f}) {
        const glm::mat3 turn = rotationZ(-0.17 * double(side)) * rotationY(0.07 * double(side));
        const auto at = [&](float along) {
            return glm::vec3(side * 0.165f, 0.800f, -0.025f) + turn * glm::vec3(0, along, 0);
        };
        body.add(ellipsoid(at(0.075f), {0.050f, 0.105f, 0.022f}, turn, 0.02f, kBack));
        Blob hollow =
            ellipsoid(at(0.085f) + turn * glm::vec3(0, 0, 0.022f), {0.034f, 0.078f, 0.016f}, turn, 0.01f, kBlush);
        hollow.carve = true;
        body.add(hollow);
    }
}

/// Eyes in lids, horns, and the row of spines down the back.
void addFeatures(Body& body) {
    addPair(body, {0.093f, 0.796f, 0.122f}, {0.062f, 0.066f, 0.052f}, 0, 0.012f, kBack);
    addPair(body, {0.094f, 0.795f, 0.134f}, {0.051f, 0.056f, 0.049f}, 0, 0.002f, kEyeSkin);
    // A gleam on each eye, both on the same side.
    body.add(ellipsoid({0.109f, 0.819f, 0.171f}, glm::vec3(0.0100f), glm::mat3(1), 0.001f, kGleam));
    body.add(ellipsoid({-0.079f, 0.819f, 0.171f}, glm::vec3(0.0100f), glm::mat3(1), 0.001f, kGleam));
    const Joint horn[] = {{{0.075f, 0.895f, -0.02f}, 0.032f},
                          {{0.092f, 0.955f, -0.055f}, 0.024f},
                          {{0.098f, 0.995f, -0.105f}, 0.013f},
                          {{0.095f, 1.012f, -0.150f}, 0.004f}};
    addLimbs(body, horn, 0.008f, kHornSkin);
}

void addSpines(Body& body) {
    constexpr Joint spines[] = {
        {{0, 0.925f, -0.035f}, 0.042f}, {{0, 0.875f, -0.130f}, 0.042f}, {{0, 0.780f, -0.165f}, 0.042f},
        {{0, 0.660f, -0.105f}, 0.040f}, {{0, 0.570f, -0.115f}, 0.045f}, {{0, 0.470f, -0.140f}, 0.050f},
        {{0, 0.365f, -0.175f}, 0.054f}, {{0, 0.260f, -0.220f}, 0.050f}, {{0.01f, 0.190f, -0.285f}, 0.044f}};
    for (size_t i = 0; i < std::size(spines); ++i) {
        const Joint& s = spines[i];
        // Each leans away from the middle of what it stands on.
        const glm::vec3 heart = i < 3 ? glm::vec3(0, 0.775f, 0.015f) : glm::vec3(0, s.at.y - 0.02f, 0.02f);
        const glm::vec3 d = s.at - heart;
        const glm::vec3 out = d / std::sqrt(glm::dot(d, d));
        body.add(
            roundCone(s.at - out * 0.02f, 0.4f * s.radius, s.at + out * s.radius, 0.1f * s.radius, 0.012f, kBlush));
    }
}

Body makeBody() {
    Body body;
    addTrunk(body);
    addLegs(body);
    addHead(body);
    addArms(body);
    addEars(body);
    addSpines(body);
    addFeatures(body);
    return body;
}

/// Materials meet along edges: a face takes the material that most of its corners have.
uint32_t faceMaterial(const Surface& surface, glm::uvec3 t) {
    const uint32_t a = surface.skins[t.x].material, b = surface.skins[t.y].material, c = surface.skins[t.z].material;
    return b == c ? b : a;
}

} // namespace

Model makeCreature(uint32_t faces) {
    Surface surface = polygonise(makeBody(), {-0.35f, 0.0f, -0.50f}, {0.52f, 1.05f, 0.36f}, faces);
    Model model;
    model.file = "creature";
    model.materials.resize(3);
    model.materials[kHide].name = "hide";
    model.materials[kHide].roughness = 0.65f;
    model.materials[kHorn].name = "horn";
    model.materials[kHorn].roughness = 0.45f;
    model.materials[kEye].name = "eye";
    model.materials[kEye].roughness = 0.1f;
    model.nodes.push_back({"creature", kNone, glm::mat4(1)});
    for (const glm::uvec3 t : surface.triangles) model.triangleMaterial.push_back(faceMaterial(surface, t));
    for (const Skin& skin : surface.skins) model.attributes.colors[0].emplace_back(skin.color, 1.0f);
    model.positions = std::move(surface.positions);
    model.attributes.normals = std::move(surface.normals);
    model.triangles = std::move(surface.triangles);
    model.triangleNode.assign(model.triangles.size(), 0);
    model.inputFaceCount = uint32_t(model.triangles.size());
    for (uint32_t f = 0; f < model.inputFaceCount; ++f) model.triangleFace.push_back(f);
    return model;
}

} // namespace xgc::bake::models
