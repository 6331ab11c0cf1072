#include "c_api.h"

#include <cmath>

namespace xgc::c {
namespace {

static_assert(XGC_POLICY_ERROR_PIXELS == uint32_t(Policy::errorPixels));
static_assert(XGC_POLICY_DISTANCE_BANDS == uint32_t(Policy::distanceBands));
static_assert(XGC_INSTANCE_CULLED == uint32_t(InstanceKind::culled));
static_assert(XGC_INSTANCE_WHOLE == uint32_t(InstanceKind::whole));
static_assert(XGC_INSTANCE_MIXED == uint32_t(InstanceKind::mixed));

XgcSelectionDesc defaults() {
    const SelectionDesc d;
    XgcSelectionDesc out{};
    out.policy = uint32_t(d.policy);
    out.view.pixelsPerUnit = d.view.pixelsPerUnit;
    out.view.forward[2] = d.view.forward.z;
    out.pixels = d.pixels;
    out.hysteresis = d.hysteresis;
    out.contributionPixels = d.contributionPixels;
    out.wholeBeyond = d.wholeBeyond;
    out.morphRate = d.morphRate;
    return out;
}

Status checkDesc(const XgcSelectionDesc& d) {
    if (d.policy > XGC_POLICY_DISTANCE_BANDS) return wrong("no such policy (the element)", d.policy);
    if (!(d.pixels >= 0)) return wrong("`pixels` is negative");
    if (!(d.contributionPixels >= 0)) return wrong("`contributionPixels` is negative");
    if (!(d.hysteresis >= 0 && d.hysteresis < 1)) return wrong("`hysteresis` must lie between 0 and below 1");
    if (!(d.wholeBeyond >= 0)) return wrong("`wholeBeyond` is negative");
    if (d.frustum.planeCount > 6) return wrong("a frustum has at most 6 planes", d.frustum.planeCount);
    if (d.triangleBudget > 0 && d.policy != XGC_POLICY_ERROR_PIXELS) {
        return wrong("a triangle budget needs XGC_POLICY_ERROR_PIXELS");
    }
    if (d.morph != 0 && (d.hysteresis > 0 || d.triangleBudget > 0)) {
        return wrong("`morph` goes without hysteresis and without a triangle budget");
    }
    if (!(d.morphRate > 0)) return wrong("`morphRate` must be positive");
    return checkRising(d.bands, d.bandCount);
}

Frustum toFrustum(const XgcFrustum& given) {
    Frustum out;
    out.planeCount = given.planeCount;
    for (uint32_t i = 0; i < given.planeCount; ++i) {
        const float(&p)[4] = given.planes[i];
        out.planes[i] = {p[0], p[1], p[2], p[3]};
    }
    return out;
}

Status toDesc(const XgcSelectionDesc* given, SelectionDesc& out) {
    XgcSelectionDesc d = defaults();
    if (Status s = readStruct(given, d); !s.ok()) return s;
    if (Status s = checkDesc(d); !s.ok()) return s;
    if (Status s = toView(&d.view, out.view); !s.ok()) return s;
    out.policy = Policy(d.policy);
    out.pixels = d.pixels;
    out.bands = {d.bands, d.bandCount};
    out.hysteresis = d.hysteresis;
    out.frustum = toFrustum(d.frustum);
    out.cullBackfaces = d.cullBackfaces != 0;
    out.contributionPixels = d.contributionPixels;
    out.triangleBudget = d.triangleBudget;
    out.boundPixels = d.boundPixels != 0;
    out.reference = d.reference ? &d.reference->selection : nullptr;
    out.coarserThanReference = std::min(d.coarserThanReference, format::kMaxLevels);
    out.wholeBeyond = d.wholeBeyond;
    out.jobs = {d.jobs.run, d.jobs.user};
    out.morph = d.morph != 0;
    out.morphRate = d.morphRate;
    return {};
}

Status checkScene(const XgcSelection& selection, const XgcScene& scene) {
    const SceneConfig& has = scene.scene.config();
    const SceneConfig& room = selection.config;
    if (has.instanceCapacity > room.instanceCapacity || has.patchCapacity > room.patchCapacity) {
        return wrong("the selection was created for a smaller scene than this one");
    }
    return {};
}

/// The reference, which a host's struct may be too old to have.
Status checkReference(const XgcSelectionDesc& desc, const XgcSelection& self, const XgcScene& scene) {
    XgcSelectionDesc d = defaults();
    if (Status s = readStruct(&desc, d); !s.ok()) return s;
    if (!d.reference) return {};
    if (d.reference == &self) return wrong("a selection is its own reference");
    return d.reference->scene == &scene ? Status{} : wrong("update the reference from this scene first");
}

} // namespace
} // namespace xgc::c

using namespace xgc;
using namespace xgc::c;

void xgcSelectionDescDefaults(XgcSelectionDesc* desc, uint32_t size) {
    if (desc) writeStruct(defaults(), size, desc);
}

XgcStatus xgcSelectionCreate(const XgcSceneConfig* config, XgcSelection** selection) {
    if (!selection) return badArgument(kNull);
    SceneConfig wanted;
    if (const Status s = toSceneConfig(config, wanted); !s.ok()) return report(s);
    std::unique_ptr<XgcSelection> made(new (std::nothrow) XgcSelection);
    if (!made) return report({StatusCode::outOfCapacity, kNoMemory, 0});
    if (const Status s = made->selection.create(wanted); !s.ok()) return report(s);
    made->config = wanted;
    *selection = made.release();
    return succeeded();
}

void xgcSelectionDestroy(XgcSelection* selection) {
    delete selection;
}

XgcStatus xgcSelectionUpdate(XgcSelection* selection, const XgcScene* scene, const XgcSelectionDesc* desc) {
    if (!selection || !scene) return badArgument(kNull);
    if (const Status s = checkScene(*selection, *scene); !s.ok()) return report(s);
    SelectionDesc wish;
    if (const Status s = toDesc(desc, wish); !s.ok()) return report(s);
    if (const Status s = checkReference(*desc, *selection, *scene); !s.ok()) return report(s);
    selection->selection.update(scene->scene, wish);
    selection->scene = scene;
    return succeeded();
}

XgcStatus xgcSelectionSet(XgcSelection* selection, const XgcScene* scene, uint32_t instance, const uint8_t* levels,
                          const float* fractions, uint32_t patchCount) {
    if (!selection || !scene) return badArgument(kNull);
    if (const Status s = checkScene(*selection, *scene); !s.ok()) return report(s);
    if (!scene->scene.hasInstance(instance)) return badArgument(kNoInstance, instance);
    const AssetView& asset = scene->assets.at(scene->scene.assetOf(instance))->view;
    if (const Status s = checkLevels(asset, levels, patchCount); !s.ok()) return report(s);
    if (const Status s = checkFractions(fractions, patchCount); !s.ok()) return report(s);
    selection->selection.set(scene->scene, instance, {levels, patchCount},
                             {fractions, fractions ? size_t(patchCount) : 0});
    selection->scene = scene;
    return succeeded();
}

XgcStatus xgcSelectionInstance(const XgcSelection* selection, uint32_t instance, XgcInstanceLevels* out) {
    if (!selection) return badArgument(kNull);
    if (const Status s = checkSize(out); !s.ok()) return report(s);
    if (!selection->scene) return badArgument("the selection was not updated yet");
    if (!selection->scene->scene.hasInstance(instance)) return badArgument(kNoInstance, instance);
    const Selection& chosen = selection->selection;
    const InstanceKind kind = chosen.kind(instance);
    XgcInstanceLevels value{};
    value.kind = uint32_t(kind);
    value.wholeState = kind == InstanceKind::whole ? chosen.wholeState(instance) : XGC_NONE;
    if (kind == InstanceKind::mixed) {
        value.patchCount = uint32_t(chosen.levels(instance).size());
        value.levels = chosen.levels(instance).data();
        value.visible = chosen.visible(instance).data();
        value.fractions = chosen.fractions(instance).data();
    }
    writeStruct(value, out->size, out);
    return succeeded();
}

XgcStatus xgcSelectionStats(const XgcSelection* selection, XgcSelectionStats* stats) {
    if (!selection) return badArgument(kNull);
    if (const Status s = checkSize(stats); !s.ok()) return report(s);
    const SelectionStats& of = selection->selection.stats();
    XgcSelectionStats value{};
    value.visibleInstances = of.visibleInstances;
    value.wholeInstances = of.wholeInstances;
    value.consideredPatches = of.consideredPatches;
    value.culledPatches = of.culledPatches;
    value.changedPatches = of.changedPatches;
    value.pixels = of.pixels;
    value.triangleBudget = of.triangleBudget;
    value.triangleBound = of.triangleBound;
    value.overBudget = of.overBudget;
    value.pixelsBound = of.pixelsBound;
    writeStruct(value, stats->size, stats);
    return succeeded();
}
