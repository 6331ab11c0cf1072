#pragma once

#include <xgc/asset.h>
#include <xgc/bake/asset_writer.h>
#include <xgc/bake/bake.h>
#include <xgc/bake/export.h>
#include <xgc/skin.h>

#include <glm/gtc/matrix_transform.hpp>

#include <cmath>
#include <filesystem>
#include <random>
#include <string>
#include <unistd.h>

/// A tube that bends at four joints and bulges by two targets: what can be posed, by construction.
namespace xgc::test {

struct TubeShape {
    uint32_t around = 40, along = 120;
};

namespace detail {

inline void addTubeRows(bake::Model& model, const TubeShape& shape) {
    bake::Attributes& a = model.attributes;
    a.morphTargets.resize(2);
    a.morphTargets[0].name = "bulge";
    a.morphTargets[1].name = "ripple";
    const auto add = [&](const glm::vec3& p, const glm::vec3& outwards) {
        model.positions.push_back(p);
        const float at = std::clamp(p.y, 0.0f, 3.999f);
        const float part = at - std::floor(at), smooth = part * part * (3 - 2 * part);
        const auto joint = uint16_t(at);
        a.joints[0].emplace_back(joint, std::min<int>(joint + 1, 3), 0, 0);
        a.weights[0].emplace_back(1 - smooth, smooth, 0, 0);
        a.morphTargets[0].positions.push_back(outwards * (0.3f * std::exp(-4 * (p.y - 2.5f) * (p.y - 2.5f))));
        a.morphTargets[1].positions.push_back(p.y < 1 ? outwards * (0.1f * std::sin(12 * p.y)) : glm::vec3(0));
    };
    for (uint32_t j = 0; j <= shape.along; ++j) {
        for (uint32_t i = 0; i < shape.around; ++i) {
            const float u = 6.2831853f * float(i) / float(shape.around), y = 4 * float(j) / float(shape.along);
            const glm::vec3 outwards(std::cos(u), 0, std::sin(u));
            add(outwards * (0.4f + 0.03f * std::sin(5 * u) * std::sin(7 * y)) + glm::vec3(0, y, 0), outwards);
        }
    }
    add({0, -0.1f, 0}, {0, -1, 0});
    add({0, 4.1f, 0}, {0, 1, 0});
}

inline void addTubeFaces(bake::Model& model, const TubeShape& shape) {
    const uint32_t n = shape.around, bottom = n * (shape.along + 1), top = bottom + 1;
    for (uint32_t i = 0; i < n; ++i) {
        const uint32_t k = (i + 1) % n;
        for (uint32_t j = 0; j < shape.along; ++j) {
            const uint32_t a = j * n + i, b = j * n + k, c = a + n, d = b + n;
            model.triangles.emplace_back(a, c, b);
            model.triangles.emplace_back(b, c, d);
        }
        model.triangles.emplace_back(bottom, i, k);
        model.triangles.emplace_back(top, shape.along * n + k, shape.along * n + i);
    }
    model.inputFaceCount = uint32_t(model.triangles.size());
    for (uint32_t f = 0; f < model.inputFaceCount; ++f) model.triangleFace.push_back(f);
    model.triangleMaterial.assign(model.triangles.size(), 0);
    model.triangleNode.assign(model.triangles.size(), 0);
}

} // namespace detail

inline bake::Model tubeModel(const TubeShape& shape = {}) {
    bake::Model model;
    detail::addTubeRows(model, shape);
    detail::addTubeFaces(model, shape);
    model.materials.emplace_back().name = "skin";
    model.nodes.push_back({"tube", bake::kNone, glm::mat4(1), 0});
    bake::Skin skin;
    skin.name = "spine";
    for (uint32_t j = 0; j < 4; ++j) {
        const glm::mat4 toMesh = glm::translate(glm::mat4(1), {0, float(j), 0});
        model.nodes.push_back({"joint" + std::to_string(j), j == 0 ? bake::kNone : j, toMesh, bake::kNone});
        skin.joints.push_back(j + 1);
        skin.inverseBind.push_back(glm::inverse(toMesh));
    }
    model.skins.push_back(skin);
    return model;
}

/// A model through the whole pipeline, opened.
struct PosedModel {
    bake::AlignedBytes bytes;
    AssetView view;
    bake::AlignedBytes pages; ///< the file, where it was baked in tiers
    std::string failure;      ///< empty where it opened

    explicit PosedModel(const bake::Model& model, uint32_t patchFaces = 512, const bake::PageOptions& cut = {}) {
        namespace fs = std::filesystem;
        const fs::path folder = fs::temp_directory_path() / ("xgc_posed_model_" + std::to_string(getpid()));
        fs::create_directories(folder);
        const bake::Status status = bake::exportModel(model, folder / "in.glb");
        failure = status.message;
        if (status.ok()) bakeFile(folder / "in.glb", folder / "out.xgc", patchFaces, cut);
        fs::remove_all(folder);
    }
    explicit PosedModel(const std::filesystem::path& file, uint32_t patchFaces = 256) {
        const std::filesystem::path out =
            std::filesystem::temp_directory_path() / ("xgc_posed_model_" + std::to_string(getpid()) + ".xgc");
        bakeFile(file, out, patchFaces, {});
        std::filesystem::remove(out);
    }
    PosedModel(const PosedModel&) = delete;
    PosedModel& operator=(const PosedModel&) = delete;

private:
    void bakeFile(const std::filesystem::path& in, const std::filesystem::path& out, uint32_t patchFaces,
                  const bake::PageOptions& cut) {
        bake::BakeOptions options;
        options.input = in;
        options.output = out;
        options.patchFaces = patchFaces;
        options.pages = cut;
        bake::BakeReport report;
        bake::Status status = bake::bake(options, report);
        if (status.ok()) status = bake::readImage(out, bytes);
        if (status.ok() && cut.tiers > 1) status = bake::readFile(out, pages);
        failure = status.message;
        if (!status.ok()) return;
        const Status opened = openAll(bytes.span(), view);
        if (!opened.ok()) failure = opened.message;
    }
};

/// A pose with its memory: nodes turned about their own origins by up to `bend`, the first joints of rows also moved
/// and scaled, and weights of targets.
struct RandomPose {
    std::vector<glm::mat4x3> joints;
    std::vector<float> weights;

    RandomPose(const AssetView& asset, std::mt19937& random, float bend, float scale = 1) {
        const auto next = [&] { return 2 * float(random() % 10001) / 10000 - 1; };
        std::vector<glm::mat4> rest(asset.nodes.size()), toParent(asset.nodes.size()), toMesh(asset.nodes.size());
        restNodes(asset, rest);
        for (size_t i = 0; i < rest.size(); ++i) {
            const uint32_t parent = asset.nodes[i].parent;
            toParent[i] = parent == format::kNone ? rest[i] : glm::inverse(rest[parent]) * rest[i];
            const glm::vec3 axis = glm::vec3(next(), next(), next()) + glm::vec3(0.01f);
            toParent[i] = glm::rotate(toParent[i], bend * next(), glm::normalize(axis));
            if (parent == format::kNone) toParent[i] = glm::scale(toParent[i], glm::vec3(scale));
        }
        nodesToMesh(asset, toParent, toMesh);
        joints.resize(asset.joints.size());
        jointMatrices(asset, toMesh, joints);
        for (size_t t = 0; t < asset.morphTargets.size(); ++t) weights.push_back(1.2f * next());
    }
    Pose pose() const { return {joints, weights}; }
};

} // namespace xgc::test
