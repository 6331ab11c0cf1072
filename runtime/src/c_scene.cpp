#include "c_api.h"
#include "scene.h"

#include <cmath>

using namespace xgc;
using namespace xgc::c;

namespace xgc::c {

Status toSceneConfig(const XgcSceneConfig* given, SceneConfig& out) {
    XgcSceneConfig config;
    xgcSceneConfigDefaults(&config, sizeof config);
    if (Status s = readStruct(given, config); !s.ok()) return s;
    out = {.assetCapacity = config.assetCapacity,
           .instanceCapacity = config.instanceCapacity,
           .assetPatchCapacity = config.assetPatchCapacity,
           .patchCapacity = config.patchCapacity,
           .steeredPartCapacity = config.steeredPartCapacity};
    return {};
}

namespace {

PartControl toControl(const XgcPartControl& control) {
    return {.importance = control.importance,
            .bias = control.bias,
            .finest = control.finest,
            .coarsest = control.coarsest,
            .hidden = control.hidden != 0};
}

XgcPartControl fromControl(const PartControl& control) {
    return {0, control.importance, control.bias, control.finest, control.coarsest, control.hidden};
}

Status checkInstance(const XgcScene* scene, uint32_t instance) {
    if (!scene) return wrong(kNull);
    return scene->scene.hasInstance(instance) ? Status{} : wrong(kNoInstance, instance);
}

Status checkPart(const XgcScene* scene, uint32_t instance, uint32_t part) {
    if (Status s = checkInstance(scene, instance); !s.ok()) return s;
    const size_t count = scene->assets.at(scene->scene.assetOf(instance))->view.parts.size();
    return part < count ? Status{} : wrong("no such part (the element)", part);
}

} // namespace
} // namespace xgc::c

void xgcSceneConfigDefaults(XgcSceneConfig* config, uint32_t size) {
    const SceneConfig d;
    if (!config) return;
    writeStruct({0, d.assetCapacity, d.instanceCapacity, d.assetPatchCapacity, d.patchCapacity, d.steeredPartCapacity},
                size, config);
}

void xgcAssetDescDefaults(XgcAssetDesc* desc, uint32_t size) {
    const AssetDesc d;
    if (desc) writeStruct({0, d.vertexOffset, d.firstMaterial}, size, desc);
}

void xgcPartControlDefaults(XgcPartControl* control, uint32_t size) {
    if (control) writeStruct(fromControl({}), size, control);
}

XgcStatus xgcSceneCreate(const XgcSceneConfig* config, XgcScene** scene) {
    if (!scene) return badArgument(kNull);
    SceneConfig wanted;
    if (const Status s = toSceneConfig(config, wanted); !s.ok()) return report(s);
    std::unique_ptr<XgcScene> made(new (std::nothrow) XgcScene);
    if (!made) return report({StatusCode::outOfCapacity, kNoMemory, 0});
    if (const Status s = made->scene.create(wanted); !s.ok()) return report(s);
    if (!made->assets.allocate(wanted.assetCapacity)) return report({StatusCode::outOfCapacity, kNoMemory, 0});
    *scene = made.release();
    return succeeded();
}

void xgcSceneDestroy(XgcScene* scene) {
    delete scene;
}

// Assets ------------------------------------------------------------------------------------------------------------

XgcStatus xgcSceneAddAsset(XgcScene* scene, const XgcAsset* asset, const XgcAssetDesc* desc, uint32_t* id) {
    if (!scene || !asset || !id) return badArgument(kNull);
    XgcAssetDesc given;
    xgcAssetDescDefaults(&given, sizeof given);
    if (const Status s = readStruct(desc, given); !s.ok()) return report(s);
    if (int64_t(given.vertexOffset) + asset->view.record->vertexCount > INT32_MAX) {
        return badArgument("vertexOffset and the asset's rows (the element) leave the range of a draw's vertexOffset",
                           asset->view.record->vertexCount);
    }
    uint32_t added = 0;
    const Status status = scene->scene.addAsset(
        {.asset = &asset->view, .vertexOffset = given.vertexOffset, .firstMaterial = given.firstMaterial}, added);
    if (!status.ok()) return report(status);
    scene->assets.set(added, asset);
    *id = added;
    return succeeded();
}

XgcStatus xgcSceneRemoveAsset(XgcScene* scene, uint32_t asset) {
    if (!scene) return badArgument(kNull);
    if (!scene->assets.at(asset)) return badArgument(kNoAsset, asset);
    if (const uint32_t count = scene->scene.impl().assets[asset].instanceCount; count > 0) {
        return badArgument("the asset still has instances (as many as the element says): remove them first", count);
    }
    scene->scene.removeAsset(asset);
    scene->assets.set(asset, nullptr);
    return succeeded();
}

// Instances ---------------------------------------------------------------------------------------------------------

XgcStatus xgcSceneAddInstance(XgcScene* scene, uint32_t asset, const XgcPlacement* placement, uint32_t* id) {
    if (!scene || !id) return badArgument(kNull);
    if (!scene->assets.at(asset)) return badArgument(kNoAsset, asset);
    Placement at;
    if (const Status s = toPlacement(placement, at); !s.ok()) return report(s);
    return report(scene->scene.addInstance(asset, at, *id));
}

XgcStatus xgcSceneRemoveInstance(XgcScene* scene, uint32_t instance) {
    if (const Status s = checkInstance(scene, instance); !s.ok()) return report(s);
    scene->scene.removeInstance(instance);
    return succeeded();
}

XgcStatus xgcSceneSetPlacement(XgcScene* scene, uint32_t instance, const XgcPlacement* placement) {
    if (const Status s = checkInstance(scene, instance); !s.ok()) return report(s);
    Placement at;
    if (const Status s = toPlacement(placement, at); !s.ok()) return report(s);
    scene->scene.setPlacement(instance, at);
    return succeeded();
}

XgcStatus xgcScenePlacement(const XgcScene* scene, uint32_t instance, XgcPlacement* placement) {
    if (const Status s = checkInstance(scene, instance); !s.ok()) return report(s);
    if (!placement) return badArgument(kNull);
    const Placement& at = scene->scene.placement(instance);
    for (int i = 0; i < 12; ++i) placement->toWorld[i] = at.toWorld[i / 3][i % 3];
    placement->maxScale = at.maxScale;
    return succeeded();
}

XgcStatus xgcSceneSetVisible(XgcScene* scene, uint32_t instance, uint32_t visible) {
    if (const Status s = checkInstance(scene, instance); !s.ok()) return report(s);
    scene->scene.setVisible(instance, visible != 0);
    return succeeded();
}

XgcStatus xgcSceneAssetOf(const XgcScene* scene, uint32_t instance, uint32_t* asset) {
    if (const Status s = checkInstance(scene, instance); !s.ok()) return report(s);
    if (!asset) return badArgument(kNull);
    *asset = scene->scene.assetOf(instance);
    return succeeded();
}

uint32_t xgcSceneInstanceEnd(const XgcScene* scene) {
    return scene ? scene->scene.instanceEnd() : 0;
}

uint32_t xgcSceneHasInstance(const XgcScene* scene, uint32_t instance) {
    return scene && scene->scene.hasInstance(instance);
}

// Parts -------------------------------------------------------------------------------------------------------------

XgcStatus xgcSceneSetPart(XgcScene* scene, uint32_t instance, uint32_t part, const XgcPartControl* control) {
    if (const Status s = checkPart(scene, instance, part); !s.ok()) return report(s);
    XgcPartControl given;
    xgcPartControlDefaults(&given, sizeof given);
    if (const Status s = readStruct(control, given); !s.ok()) return report(s);
    if (!(given.importance > 0) || !std::isfinite(given.importance)) {
        return badArgument("importance must be positive and finite");
    }
    return report(scene->scene.setPart(instance, part, toControl(given)));
}

XgcStatus xgcScenePart(const XgcScene* scene, uint32_t instance, uint32_t part, XgcPartControl* control) {
    if (const Status s = checkPart(scene, instance, part); !s.ok()) return report(s);
    if (const Status s = checkSize(control); !s.ok()) return report(s);
    writeStruct(fromControl(scene->scene.part(instance, part)), control->size, control);
    return succeeded();
}

XgcStatus xgcSceneClearParts(XgcScene* scene, uint32_t instance) {
    if (const Status s = checkInstance(scene, instance); !s.ok()) return report(s);
    scene->scene.clearParts(instance);
    return succeeded();
}

XgcStatus xgcSceneWholeState(const XgcScene* scene, uint32_t asset, uint32_t state, XgcWholeState* out, uint8_t* levels,
                             uint32_t patchCount) {
    if (!scene) return badArgument(kNull);
    if (const Status s = checkSize(out); !s.ok()) return report(s);
    if (!scene->assets.at(asset)) return badArgument(kNoAsset, asset);
    const uint32_t count = scene->scene.wholeStateCount(asset);
    if (state >= count) return badArgument("no such state (the element)", state);
    if (const uint32_t patches = scene->assets.at(asset)->view.patchCount(); levels && patchCount != patches) {
        return badArgument(kPatchCount, patches);
    }
    writeStruct({0, scene->scene.wholeError(asset, state), scene->scene.wholeTriangles(asset, state), count}, out->size,
                out);
    if (levels) scene->scene.wholeLevels(asset, state, {levels, patchCount});
    return succeeded();
}
