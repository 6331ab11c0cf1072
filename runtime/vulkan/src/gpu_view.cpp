#include "gpu_view.h"

#include "barriers.h"

#include <xgc/draw_list.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <utility>

#include "gpu_faces_comp.h"
#include "gpu_hide_comp.h"
#include "gpu_place_comp.h"
#include "gpu_pyramid_comp.h"
#include "gpu_runs_comp.h"
#include "gpu_scan_comp.h"
#include "gpu_select_comp.h"

namespace xgc::vulkan {
namespace {

constexpr Access kComputeWrites{VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT};
constexpr Access kComputes{VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                           VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT};
/// All that reads what is made.
constexpr VkPipelineStageFlags2 kReaders = VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT | VK_PIPELINE_STAGE_2_INDEX_INPUT_BIT |
                                           VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT |
                                           VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT | VK_PIPELINE_STAGE_2_COPY_BIT;
constexpr Access kReads{kReaders, VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT | VK_ACCESS_2_INDEX_READ_BIT |
                                      VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_TRANSFER_READ_BIT};

VkResult makeCompute(const Context& context, VkPipelineLayout layout, std::span<const uint32_t> words,
                     VkPipeline& out) {
    VkShaderModuleCreateInfo code{};
    code.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO;
    code.codeSize = words.size_bytes();
    code.pCode = words.data();
    VkComputePipelineCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO;
    info.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
    info.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
    info.stage.pName = "main";
    info.layout = layout;
    const Functions& vk = context.vk();
    VkResult result = vk.vkCreateShaderModule(context.device(), &code, context.allocation(), &info.stage.module);
    if (result != VK_SUCCESS) return result;
    result = vk.vkCreateComputePipelines(context.device(), VK_NULL_HANDLE, 1, &info, context.allocation(), &out);
    vk.vkDestroyShaderModule(context.device(), info.stage.module, context.allocation());
    return result;
}

/// Hands out places in a buffer, one behind the other.
class Places {
public:
    VkDeviceSize take(VkDeviceSize bytes) {
        const VkDeviceSize at = end_;
        end_ += (bytes + 63) / 64 * 64;
        return at;
    }
    VkDeviceSize end() const { return end_; }

private:
    VkDeviceSize end_ = 0;
};

} // namespace

// Pipelines ---------------------------------------------------------------------------------------------------------

Status GpuPipelines::create(const Context& context) {
    context_ = &context;
    VkPushConstantRange range{};
    range.stageFlags = VK_SHADER_STAGE_COMPUTE_BIT;
    range.size = sizeof(shader::GpuPush);
    VkPipelineLayoutCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO;
    info.pushConstantRangeCount = 1;
    info.pPushConstantRanges = &range;
    VkResult result = context.vk().vkCreatePipelineLayout(context.device(), &info, context.allocation(), &layout_);
    const std::span<const uint32_t> words[] = {gpu_select_comp, gpu_place_comp,   gpu_runs_comp, gpu_scan_comp,
                                               gpu_faces_comp,  gpu_pyramid_comp, gpu_hide_comp};
    for (uint32_t stage = 0; stage < stageCount && result == VK_SUCCESS; ++stage) {
        result = makeCompute(context, layout_, words[stage], stages_[stage]);
    }
    return result == VK_SUCCESS ? Status{} : refused("a compute pipeline could not be made", result);
}

GpuPipelines::~GpuPipelines() {
    if (!context_) return;
    const Functions& vk = context_->vk();
    for (VkPipeline stage : stages_) {
        if (stage) vk.vkDestroyPipeline(context_->device(), stage, context_->allocation());
    }
    if (layout_) vk.vkDestroyPipelineLayout(context_->device(), layout_, context_->allocation());
}

// Set-up ------------------------------------------------------------------------------------------------------------

namespace {

GpuView::Lists placeLists(const RendererConfig& config, uint32_t stateCapacity, Places& places) {
    constexpr VkDeviceSize kWord = sizeof(uint32_t);
    GpuView::Lists at{};
    at.wholeFirsts = places.take((stateCapacity + 1) * kWord);
    at.wholeCounts = places.take((stateCapacity + 1) * kWord);
    at.ranks = places.take(config.instanceCapacity * kWord);
    at.ids = places.take(config.instanceCapacity * kWord);
    at.places = places.take(config.gpu.runCapacity * sizeof(shader::GpuRunPlace));
    at.items = places.take(config.gpu.drawCapacity * sizeof(shader::GpuItem));
    at.totals = places.take(sizeof(shader::GpuTotals));
    at.commands = places.take(shader::kDrawKinds * config.gpu.drawCapacity * sizeof(DrawCommand));
    at.draws = places.take(shader::kDrawKinds * config.gpu.drawCapacity * sizeof(shader::DrawRecord));
    return at;
}

/// Texels of an image and all coarser levels, rounded up.
VkDeviceSize pyramidTexels(VkDeviceSize pixels) {
    return pixels * 2 + 4096; // thin images: each level is half of the one before and a row
}

} // namespace

Status GpuView::create(const Context& context, const RendererConfig& config, uint32_t stateCapacity) {
    context_ = &context;
    framesInFlight_ = config.framesInFlight;
    drawCapacity_ = std::min(config.gpu.drawCapacity, context.maxDrawIndirectCount());
    const bool reversed =
        config.depthCompare == VK_COMPARE_OP_GREATER || config.depthCompare == VK_COMPARE_OP_GREATER_OR_EQUAL;
    depthPixels_ = config.depthFormat == VK_FORMAT_D32_SFLOAT && reversed ? config.gpu.depthPixels : 0;
    Places places;
    places.take(config.instanceCapacity * sizeof(shader::GpuInstanceState));
    slotsAt_ = places.take(config.patchCapacity * sizeof(uint32_t));
    lists_[0] = placeLists(config, stateCapacity, places);
    if (depthPixels_ > 0) {
        lists_[1] = placeLists(config, stateCapacity, places);
        depthAt_ = places.take(pyramidTexels(depthPixels_) * sizeof(float));
    }
    Status status = made_.create(context, places.end(),
                                 VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT |
                                     VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT |
                                     VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT,
                                 Residence::device);
    for (uint32_t phase = 0; phase < (depthPixels_ > 0 ? 2u : 1u) && status.ok(); ++phase) {
        status =
            indices_[phase].create(context, config.gpu.indexBytes,
                                   VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_INDEX_BUFFER_BIT |
                                       VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT,
                                   Residence::device);
    }
    if (status.ok()) {
        status = frames_.create(context, 2 * framesInFlight_ * sizeof(shader::GpuFrame),
                                VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT,
                                Residence::upload);
    }
    if (status.ok()) {
        status = readBack_.create(context, 2 * framesInFlight_ * sizeof(shader::GpuTotals),
                                  VK_BUFFER_USAGE_TRANSFER_DST_BIT, Residence::download);
    }
    if (!status.ok()) return status;
    std::memset(readBack_.mapped().data(), 0, readBack_.mapped().size());
    asked_.itemCapacity = config.gpu.drawCapacity;
    asked_.drawCapacity = drawCapacity_;
    asked_.indexCapacity = uint32_t(config.gpu.indexBytes / sizeof(uint32_t));
    return {};
}

void GpuView::point(shader::GpuFrame& frame, bool late) const {
    const VkDeviceAddress at = made_.address();
    const Lists& lists = lists_[late];
    frame.states = at;
    frame.slots = at + slotsAt_;
    frame.wholeFirsts = at + lists.wholeFirsts;
    frame.wholeCounts = at + lists.wholeCounts;
    frame.ranks = at + lists.ranks;
    frame.ids = at + lists.ids;
    frame.places = at + lists.places;
    frame.items = at + lists.items;
    frame.totals = at + lists.totals;
    frame.commands = at + lists.commands;
    frame.draws = at + lists.draws;
    frame.indices = indices_[late].address();
}

GpuView::DrawRange GpuView::drawRange(bool late, uint32_t kind) const {
    const Lists& lists = lists_[late];
    const uint32_t first = kind * drawCapacity_;
    return {first, lists.commands + first * sizeof(DrawCommand),
            lists.totals + offsetof(shader::GpuTotals, kindDraws) + kind * sizeof(uint32_t)};
}

bool GpuView::hasKind(uint32_t kind) const {
    const uint32_t first = kind == 0 ? 0 : asked_.kindRuns[kind - 1];
    return first < (kind + 1 < shader::kDrawKinds ? asked_.kindRuns[kind] : runCount_);
}

// A frame -----------------------------------------------------------------------------------------------------------

const char* GpuView::lacks(const SelectionDesc& desc) {
    if (desc.triangleBudget > 0) return "SelectionDesc::triangleBudget";
    if (desc.morph) return "SelectionDesc::morph";
    if (desc.reference) return "SelectionDesc::reference";
    return nullptr;
}

void GpuView::ask(const SelectionDesc& desc) {
    const float keep = 1 - desc.hysteresis, factor = 1 / keep; // as levelPolicy does
    shader::GpuFrame& f = asked_;
    f.eye = glm::vec4(desc.view.eye, 1);
    f.forward = glm::vec4(desc.view.forward, 0);
    f.planeCount = desc.frustum.planeCount;
    std::copy_n(desc.frustum.planes.begin(), desc.frustum.planeCount, f.planes);
    f.byBands = desc.policy == Policy::distanceBands;
    f.bandCount = uint32_t(std::min<size_t>(desc.bands.size(), shader::kNoLevel));
    std::copy_n(desc.bands.begin(), f.bandCount, f.bands);
    f.orthographic = desc.view.orthographic;
    f.pixelsPerUnit = desc.view.pixelsPerUnit;
    f.nearest = desc.view.nearest;
    f.contributionPixels = desc.contributionPixels;
    f.cullBackfaces = desc.cullBackfaces;
    f.loosePixels = desc.pixels;
    f.middlePixels = desc.pixels * keep;
    f.tightPixels = desc.pixels * keep * keep;
    f.looseBand = 1;
    f.middleBand = factor;
    f.tightBand = factor * factor;
    f.wholeInner = desc.wholeBeyond;
    f.wholeOuter = desc.wholeBeyond / (keep * keep);
    f.beltInner = desc.wholeBeyond * keep;
}

void GpuView::write(const GpuScene& scene, uint64_t frame) {
    part_ = uint32_t(frame % framesInFlight_);
    std::array<shader::GpuTotals, 2> totals;
    std::memcpy(totals.data(), readBack_.mapped().data() + part_ * sizeof totals, sizeof totals);
    std::memset(readBack_.mapped().data() + part_ * sizeof totals, 0, sizeof totals);
    stats_ = {};
    for (const shader::GpuTotals& t : totals) {
        stats_.draws += t.drawCount;
        stats_.patches += t.itemCount;
        stats_.indices += t.indexCount;
        stats_.triangles += t.triangles;
        stats_.incomplete |= t.missingItems > 0 || t.missingIndices > 0;
    }
    stats_.latePatches = totals[1].itemCount;
    scene.address(asked_);
    instanceEnd_ = asked_.instanceEnd;
    runCount_ = asked_.runCount;
    for (const bool late : {false, true}) {
        shader::GpuFrame out = asked_;
        point(out, late);
        out.phase = late ? shader::kPhaseUnseen : occludes_ ? shader::kPhaseSeen : shader::kPhaseAll;
        std::memcpy(frames_.mapped().data() + frameAt(late), &out, sizeof out);
    }
    clears_ = !std::exchange(begun_, true);
}

void GpuView::dispatch(VkCommandBuffer cmd, const GpuPipelines& pipelines, bool late, const Dispatch& what) const {
    const Functions& vk = context_->vk();
    const shader::GpuPush push{frames_.address() + frameAt(late), what.step, 0};
    vk.vkCmdBindPipeline(cmd, VK_PIPELINE_BIND_POINT_COMPUTE, pipelines.at(what.stage));
    vk.vkCmdPushConstants(cmd, pipelines.layout(), VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof push, &push);
    if (what.stage == GpuPipelines::faces) {
        vk.vkCmdDispatchIndirect(cmd, made_.handle(), lists_[late].totals);
    } else if (what.groups > 0) {
        const uint32_t rows = (what.groups + shader::kGroupsPerRow - 1) / shader::kGroupsPerRow;
        vk.vkCmdDispatch(cmd, std::min(what.groups, shader::kGroupsPerRow), rows, 1);
    }
    constexpr Access kNext{kComputes.stages | VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT,
                           kComputes.access | VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT};
    memoryBarrier(vk, cmd, kComputeWrites, kNext);
}

void GpuView::recordLists(VkCommandBuffer cmd, const GpuPipelines& pipelines, bool late) const {
    const Dispatch all[] = {{GpuPipelines::place},   {GpuPipelines::runs, 0, runCount_},
                            {GpuPipelines::scan},    {GpuPipelines::runs, 1, runCount_},
                            {GpuPipelines::faces},   {GpuPipelines::scan, 1},
                            {GpuPipelines::faces, 1}};
    for (const Dispatch& one : all) dispatch(cmd, pipelines, late, one);
    const Functions& vk = context_->vk();
    memoryBarrier(vk, cmd, kComputeWrites, kReads);
    const VkBufferCopy copy{lists_[late].totals, (2 * part_ + late) * sizeof(shader::GpuTotals),
                            sizeof(shader::GpuTotals)};
    vk.vkCmdCopyBuffer(cmd, made_.handle(), readBack_.handle(), 1, &copy);
    memoryBarrier(vk, cmd, {VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT},
                  {VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT});
}

void GpuView::record(VkCommandBuffer cmd, const GpuPipelines& pipelines) const {
    const Functions& vk = context_->vk();
    if (clears_) {
        // No instance has generation 0: nothing was seen yet.
        vk.vkCmdFillBuffer(cmd, made_.handle(), 0, lists_[0].wholeFirsts, 0);
        memoryBarrier(vk, cmd, {VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT}, kComputes);
    }
    // The last frame's draws read what is written now.
    memoryBarrier(vk, cmd, {kReaders | kComputes.stages, kComputeWrites.access}, kComputes);
    dispatch(cmd, pipelines, false, {GpuPipelines::select, 0, instanceEnd_});
    recordLists(cmd, pipelines, false);
}

Status GpuView::recordLate(VkCommandBuffer cmd, const GpuPipelines& pipelines, const glm::mat4& worldToClip,
                           VkImage depth, VkExtent2D size) {
    const VkDeviceSize pixels = VkDeviceSize(size.width) * size.height;
    if (pixels > depthPixels_) {
        return {StatusCode::outOfCapacity, "recordOcclusion: raise GpuPathConfig::depthPixels", pixels};
    }
    auto& frame = *reinterpret_cast<shader::GpuFrame*>(frames_.mapped().data() + frameAt(true));
    frame.worldToClip = worldToClip;
    frame.depth = made_.address() + depthAt_;
    frame.depthSize[0] = size.width;
    frame.depthSize[1] = size.height;
    const Functions& vk = context_->vk();
    VkBufferImageCopy region{};
    region.bufferOffset = depthAt_;
    region.imageSubresource = {VK_IMAGE_ASPECT_DEPTH_BIT, 0, 0, 1};
    region.imageExtent = {size.width, size.height, 1};
    // The last frame looked at what lies there.
    constexpr Access kCopies{VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT};
    memoryBarrier(vk, cmd, {kReaders | kComputes.stages, kComputeWrites.access}, kCopies);
    vk.vkCmdCopyImageToBuffer(cmd, depth, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, made_.handle(), 1, &region);
    memoryBarrier(vk, cmd, kCopies, kComputes);
    for (uint32_t level = 1; size.width > 1 || size.height > 1; ++level) {
        size = {(size.width + 1) / 2, (size.height + 1) / 2};
        dispatch(cmd, pipelines, true, {GpuPipelines::pyramid, level, (size.width * size.height + 63) / 64});
    }
    dispatch(cmd, pipelines, true, {GpuPipelines::hide, 0, instanceEnd_});
    recordLists(cmd, pipelines, true);
    return {};
}

} // namespace xgc::vulkan
