#include "gpu_view.h"

#include "barriers.h"

#include <xgc/draw_list.h>

#include <algorithm>
#include <cstring>
#include <utility>

#include "gpu_faces_comp.h"
#include "gpu_place_comp.h"
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
    const std::span<const uint32_t> words[] = {gpu_select_comp, gpu_place_comp, gpu_runs_comp, gpu_scan_comp,
                                               gpu_faces_comp};
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

Status GpuView::create(const Context& context, const RendererConfig& config, uint32_t stateCapacity) {
    context_ = &context;
    framesInFlight_ = config.framesInFlight;
    drawCapacity_ = std::min(config.gpu.drawCapacity, context.maxDrawIndirectCount());
    constexpr VkDeviceSize kWord = sizeof(uint32_t);
    Places places;
    places.take(config.instanceCapacity * sizeof(shader::GpuInstanceState));
    slotsAt_ = places.take(config.patchCapacity * kWord);
    wholeFirstsAt_ = places.take((stateCapacity + 1) * kWord);
    wholeCountsAt_ = places.take((stateCapacity + 1) * kWord);
    ranksAt_ = places.take(config.instanceCapacity * kWord);
    idsAt_ = places.take(config.instanceCapacity * kWord);
    placesAt_ = places.take(config.gpu.runCapacity * sizeof(shader::GpuRunPlace));
    itemsAt_ = places.take(config.gpu.drawCapacity * sizeof(shader::GpuItem));
    totalsAt_ = places.take(sizeof(shader::GpuTotals));
    commandsAt_ = places.take(config.gpu.drawCapacity * sizeof(DrawCommand));
    drawsAt_ = places.take(config.gpu.drawCapacity * sizeof(shader::DrawRecord));
    indicesAt_ = places.take(config.gpu.indexBytes);
    Status status = made_.create(context, places.end(),
                                 VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT |
                                     VK_BUFFER_USAGE_INDEX_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT |
                                     VK_BUFFER_USAGE_TRANSFER_DST_BIT | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT,
                                 Residence::device);
    if (status.ok()) {
        status = frames_.create(context, framesInFlight_ * sizeof(shader::GpuFrame),
                                VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT,
                                Residence::upload);
    }
    if (status.ok()) {
        status = readBack_.create(context, framesInFlight_ * sizeof(shader::GpuTotals),
                                  VK_BUFFER_USAGE_TRANSFER_DST_BIT, Residence::download);
    }
    if (!status.ok()) return status;
    std::memset(readBack_.mapped().data(), 0, readBack_.mapped().size());
    const VkDeviceAddress at = made_.address();
    asked_.states = at;
    asked_.slots = at + slotsAt_;
    asked_.wholeFirsts = at + wholeFirstsAt_;
    asked_.wholeCounts = at + wholeCountsAt_;
    asked_.ranks = at + ranksAt_;
    asked_.ids = at + idsAt_;
    asked_.places = at + placesAt_;
    asked_.items = at + itemsAt_;
    asked_.totals = at + totalsAt_;
    asked_.commands = at + commandsAt_;
    asked_.draws = at + drawsAt_;
    asked_.indices = at + indicesAt_;
    asked_.itemCapacity = config.gpu.drawCapacity;
    asked_.drawCapacity = drawCapacity_;
    asked_.indexCapacity = uint32_t(config.gpu.indexBytes / kWord);
    return {};
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
    shader::GpuTotals totals;
    std::memcpy(&totals, readBack_.mapped().data() + part_ * sizeof totals, sizeof totals);
    stats_ = {totals.drawCount, totals.itemCount, totals.indexCount,
              totals.missingItems > 0 || totals.missingIndices > 0};
    shader::GpuFrame out = asked_;
    scene.address(out);
    out.phase = shader::kPhaseAll;
    instanceEnd_ = out.instanceEnd;
    runCount_ = out.runCount;
    clears_ = !std::exchange(begun_, true);
    std::memcpy(frames_.mapped().data() + part_ * sizeof out, &out, sizeof out);
}

void GpuView::dispatch(VkCommandBuffer cmd, const GpuPipelines& pipelines, GpuPipelines::Stage stage, uint32_t step,
                       uint32_t groups) const {
    const Functions& vk = context_->vk();
    const shader::GpuPush push{frames_.address() + part_ * sizeof(shader::GpuFrame), step, 0};
    vk.vkCmdBindPipeline(cmd, VK_PIPELINE_BIND_POINT_COMPUTE, pipelines.at(stage));
    vk.vkCmdPushConstants(cmd, pipelines.layout(), VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof push, &push);
    if (stage == GpuPipelines::faces) {
        vk.vkCmdDispatchIndirect(cmd, made_.handle(), totalsAt_);
    } else if (groups > 0) {
        const uint32_t rows = (groups + shader::kGroupsPerRow - 1) / shader::kGroupsPerRow;
        vk.vkCmdDispatch(cmd, std::min(groups, shader::kGroupsPerRow), rows, 1);
    }
    constexpr Access kNext{kComputes.stages | VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT,
                           kComputes.access | VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT};
    memoryBarrier(vk, cmd, kComputeWrites, kNext);
}

void GpuView::record(VkCommandBuffer cmd, const GpuPipelines& pipelines) const {
    const Functions& vk = context_->vk();
    if (clears_) {
        // No instance has generation 0: nothing was seen yet.
        vk.vkCmdFillBuffer(cmd, made_.handle(), 0, totalsAt_, 0);
        memoryBarrier(vk, cmd, {VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT}, kComputes);
    }
    // The last frame's draws read what is written now.
    memoryBarrier(vk, cmd, {kReaders | kComputes.stages, kComputeWrites.access}, kComputes);
    dispatch(cmd, pipelines, GpuPipelines::select, 0, instanceEnd_);
    dispatch(cmd, pipelines, GpuPipelines::place, 0, 1);
    dispatch(cmd, pipelines, GpuPipelines::runs, 0, runCount_);
    dispatch(cmd, pipelines, GpuPipelines::scan, 0, 1);
    dispatch(cmd, pipelines, GpuPipelines::runs, 1, runCount_);
    dispatch(cmd, pipelines, GpuPipelines::faces, 0, 0);
    dispatch(cmd, pipelines, GpuPipelines::scan, 1, 1);
    dispatch(cmd, pipelines, GpuPipelines::faces, 1, 0);
    memoryBarrier(vk, cmd, kComputeWrites, kReads);
    const VkBufferCopy copy{totalsAt_, part_ * sizeof(shader::GpuTotals), sizeof(shader::GpuTotals)};
    vk.vkCmdCopyBuffer(cmd, made_.handle(), readBack_.handle(), 1, &copy);
    memoryBarrier(vk, cmd, {VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT},
                  {VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT});
}

} // namespace xgc::vulkan
