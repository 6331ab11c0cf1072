#include "view_scenes.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cmath>

namespace xgc::bench {
namespace {

glm::vec3 centerOf(const AssetView& asset) {
    const float* c = asset.record->sphereCenter;
    return {c[0], c[1], c[2]};
}

float at(uint32_t frame) {
    return float(frame) / float(kFlightFrames - 1);
}

/// From twelve radii away down to the surface, turning round the asset.
void approach(ViewScene& scene) {
    const glm::vec3 center = centerOf(scene.asset.view);
    const float radius = scene.asset.view.record->sphereRadius;
    for (uint32_t f = 0; f < kFlightFrames; ++f) {
        const float t = at(f), distance = radius * 12 * std::pow(0.75f / 12, t), angle = 2 * t;
        const glm::vec3 from(std::sin(angle), 0.3f, std::cos(angle));
        scene.flight.push_back({center + distance * glm::normalize(from), center});
    }
}

/// Height of the ground below a point: of the nearest vertex of level 0.
float groundAt(const AssetView& asset, const glm::vec3& point) {
    float best = INFINITY, height = 0;
    for (uint32_t row = 0; row < asset.record->baseVertexCount; ++row) {
        const glm::vec3 d = asset.positions[row] - point;
        const float away = d.x * d.x + d.z * d.z;
        if (away < best) best = away, height = asset.positions[row].y;
    }
    return height;
}

/// From high above down over the ground, and along it.
void skim(ViewScene& scene) {
    const AssetView& asset = scene.asset.view;
    const glm::vec3 center = centerOf(asset);
    const float radius = asset.record->sphereRadius;
    for (uint32_t f = 0; f < kFlightFrames; ++f) {
        const float t = at(f), x = -0.55f + 1.0f * t;
        glm::vec3 eye = center + radius * glm::vec3(x, 0, 0.35f * std::sin(3 * t));
        eye.y = groundAt(asset, eye) + radius * (0.006f + 1.2f * std::pow(1 - t, 4.0f));
        const glm::vec3 ahead = eye + radius * glm::vec3(0.3f, -0.02f - 0.25f * (1 - t), 0.1f * std::cos(3 * t));
        scene.flight.push_back({eye, ahead});
    }
}

/// Over and between a crowd on a plane.
void walk(ViewScene& scene, float side) {
    const float radius = scene.asset.view.record->sphereRadius;
    for (uint32_t f = 0; f < kFlightFrames; ++f) {
        const float t = at(f);
        const glm::vec3 eye(side * (0.1f + 0.8f * t), radius * (0.3f + 6 * (1 - t) * (1 - t)),
                            side * (0.15f + 0.6f * t * t) + radius);
        scene.flight.push_back({eye, eye + radius * glm::vec3(1, -0.5f * (1 - t), 1.2f * std::cos(2 * t))});
    }
}

void crowd(ViewScene& scene) {
    constexpr uint32_t kSide = 10;
    const glm::vec3 center = centerOf(scene.asset.view);
    const float spacing = 2.2f * scene.asset.view.record->sphereRadius;
    scene.instances.clear();
    for (uint32_t i = 0; i < kSide * kSide; ++i) {
        glm::mat4 m = glm::translate(glm::mat4(1), spacing * glm::vec3(float(i % kSide), 0, float(i / kSide)));
        m = glm::rotate(m, 2.4f * float(i), glm::vec3(0, 1, 0));
        scene.instances.push_back(makePlacement(glm::translate(m, -center)));
    }
    walk(scene, spacing * float(kSide));
}

void markClose(ViewScene& scene) {
    const AssetView& asset = scene.asset.view;
    for (const Pose& pose : scene.flight) {
        bool close = false;
        for (const Placement& placement : scene.instances) {
            const glm::vec3 center = placement.toWorld * glm::vec4(centerOf(asset), 1);
            close |= glm::length(pose.eye - center) < 1.5f * placement.maxScale * asset.record->sphereRadius;
        }
        scene.close.push_back(close);
    }
}

bake::Status make(const Source& source, ViewScene& scene) {
    Subject subject;
    const bake::Status loaded = load(source, subject);
    if (!loaded.ok()) return loaded;
    const bake::Hierarchy hierarchy = build(subject, subject.parts);
    const bake::Status laidOut =
        layOut(subject, subject.parts, hierarchy, measureErrors(subject, hierarchy), scene.asset);
    if (!laidOut.ok()) return laidOut;
    format::MaterialRecord grey = scene.asset.view.materials[0];
    std::fill_n(grey.baseColor, 4, 0.8f);
    std::fill_n(grey.emissive, 3, 0.0f);
    grey.metallic = 0;
    grey.roughness = 0.7f;
    scene.greyMaterials.assign(scene.asset.view.materials.size(), grey);
    scene.grey = scene.asset.view;
    scene.grey.materials = scene.greyMaterials;
    scene.instances = {Placement{}};
    scene.nearest = 0.004f * scene.asset.view.record->sphereRadius;
    return {};
}

} // namespace

bake::Status viewScenes(const Flags& flags, std::vector<std::unique_ptr<ViewScene>>& out) {
    std::vector<Source> sources = {{"terrain", {}, 1'000'000, false, true},
                                   {"temple", {}, 120'000, false, true},
                                   {"creatures", {}, 60'000, false, true}};
    for (Source& source : dragon()) {
        source.name = "dragon";
        source.normals = true;
        sources.push_back(source);
        break;
    }
    if (!flags.data.empty()) {
        sources.push_back(helmet(flags.data));
        sources.back().name = "helmet";
    }
    for (Source& source : sources) {
        if (!flags.wantsModel(source.name)) continue;
        auto scene = std::make_unique<ViewScene>();
        scene->name = source.name;
        if (source.name == "creatures") source.name = "creature";
        const bake::Status made = make(source, *scene);
        if (!made.ok()) return made;
        if (scene->name == "terrain") {
            skim(*scene);
        } else if (scene->name == "creatures") {
            crowd(*scene);
        } else {
            approach(*scene);
        }
        markClose(*scene);
        out.push_back(std::move(scene));
    }
    return {};
}

} // namespace xgc::bench
